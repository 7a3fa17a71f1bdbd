//! Forces and torques that a user adds to those of a simulation.

use domain::Vector;
use std::error::Error;

/// Loads on all particles in the order of their ids. An empty list stands for no force, or no torque, on any
/// particle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AppliedLoads {
    /// Force on each particle.
    pub forces: Vec<Vector>,
    /// Torque on each particle.
    pub torques: Vec<Vector>,
}

/// Loads as a function of the positions of all particles, in the order of their ids and without periodicity, and of
/// the time. It is called on the first rank alone.
pub type LoadFunction = Box<dyn FnMut(&[Vector], f64) -> Result<AppliedLoads, Box<dyn Error>>>;

/// Error of simulations whose particles accept no user-defined loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("forces of one's own act on the spheres of suspensions; scenes of this kind take none")]
pub struct NoLoads;
