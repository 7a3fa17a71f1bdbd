//! Measurements of a run: stresses on the walls with errors, profiles across the gap, a map of the
//! solid fraction, balances.

mod balance;
mod map;
mod measured;
mod profile;
mod sample;
mod stress;
#[cfg(test)]
mod tests;

pub use balance::{Balance, Start};
pub use map::DensityMap;
pub use measured::Measured;
pub use profile::{Layer, Profile, profile_bytes};
pub use sample::Sample;
pub use stress::{WallSeries, WallStress};
