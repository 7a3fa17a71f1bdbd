//! Time integrators, one a file.

pub mod adams_bashforth;
pub mod adaptive;
pub mod brownian;
pub mod implicit;
mod motion;
pub mod substeps;
