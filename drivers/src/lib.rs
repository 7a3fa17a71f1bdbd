//! Granular drivers on the particle store of the suspension code, without a fluid grid.

pub mod continuum;
pub mod disks;
mod fraction;
mod parameter;
pub mod shear_cell;
mod widest;

pub use parameter::ParameterError;
