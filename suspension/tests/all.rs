//! Tests of suspensions, in one program: each file here has to be one of its modules to be run.

mod adaptive_steps;
mod applied_loads;
mod bodies;
mod bounded_mobility;
mod brownian;
mod constant_flux;
mod contacts;
mod extension;
mod fields;
mod implicit_steps;
mod lattices;
mod noise;
mod open_extension;
mod open_space;
mod orientations;
mod protocols;
mod rearranged;
mod registered_forces;
mod runs;
mod settling;
mod stress;
mod support;
mod surface_forces;
mod tethers;
mod turned;
mod walls;
