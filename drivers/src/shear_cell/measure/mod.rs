//! What a run measures: stresses on the walls with errors, profiles across the gap, a map of the density, balances.

mod balance;
mod map;
mod profile;
mod sample;
mod stress;

pub use balance::{Balance, Start};
pub use map::DensityMap;
pub use profile::{Layer, Profile};
pub use sample::Sample;
pub use stress::{Estimate, WallStress, estimate};
