//! Time integrators, one a file.

pub mod adams_bashforth;
pub mod adaptive;
pub mod brownian;
pub mod implicit;
pub mod substeps;
