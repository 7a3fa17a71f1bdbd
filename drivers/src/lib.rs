//! Granular drivers on the particle store of the suspension code, without a fluid grid.

pub mod continuum;
pub mod disks;
mod error;
mod fraction;
mod parameter;
pub mod shear_cell;
mod widest;

pub use error::StartError;
pub use parameter::ParameterError;
