//! Measurements of a run: stresses on the walls with errors, profiles across the gap, a map of the
//! solid fraction, balances.

mod balance;
mod map;
mod measured;
mod profile;
mod sample;
#[cfg(test)]
mod tests;

pub use balance::{Balance, InitialBalance};
pub use map::DensityMap;
pub use measured::{Measurements, WallStress};
pub use profile::{Layer, LayerProfile, profile_bytes};
pub use sample::CellSample;
