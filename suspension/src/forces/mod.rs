//! Non-hydrodynamic forces on the particles: their interface, a file for each, and the list of those of a suspension.

pub mod acting;
pub mod contacts;
pub mod dipoles;
mod external;
pub mod force;
mod list;
mod near_dipoles;
pub mod pairwise;
pub mod surface;
pub mod tethers;
pub mod user;

pub use list::{Forces, NamedMoments, SharedRanges};
