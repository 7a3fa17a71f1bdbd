//! Bonds between listed spheres, and traps: springs that act at any distance.

mod bonds;
mod start;
mod traps;

pub use bonds::Bonds;
pub use start::{check, tie};
pub use traps::Traps;
