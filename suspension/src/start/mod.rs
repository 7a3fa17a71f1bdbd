//! Start of a run: positions of a model, and its memory and plan.

pub mod bodies;
mod given_bodies;
pub mod given_positions;
mod lattice;
pub mod memory;
pub mod orientations;
pub mod placement;
pub mod plan;
pub mod rearranged;
pub mod setup;
