//! Bonds between listed spheres, and traps: springs that act at any distance.

mod beam;
mod beam_ends;
mod bond;
mod bonds;
mod moving_bonds;
mod start;
mod traps;

pub use bond::BondTotals;
pub use bonds::Bonds;
pub use moving_bonds::MovingBonds;
pub use start::{check, tie};
pub use traps::Traps;
