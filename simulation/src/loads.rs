//! Forces and torques that a user adds to those of a simulation.

use crate::NeighbourList;
use domain::{Tensor, Vector};
use std::error::Error;

/// Loads on all particles in the order of their ids. An empty list stands for no force, or no torque, on any
/// particle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AppliedLoads {
    /// Force on each particle.
    pub forces: Vec<Vector>,
    /// Torque on each particle.
    pub torques: Vec<Vector>,
    /// Each particle's share of the symmetric first moments of the forces between particles, which the stress has a
    /// part of over the volume: `-sym((x_i - x_j) F_ij)` of each pair. None where the forces have no part in the
    /// stress.
    pub moments: Vec<Tensor>,
}

/// Loads as a function of the positions of all particles, in the order of their ids and without periodicity, and of
/// the time. It is called on the first rank alone.
pub type LoadFunction = Box<dyn FnMut(&[Vector], f64) -> Result<AppliedLoads, Box<dyn Error>>>;

/// The force on the first of each pair of a list of neighbours, at a time; the second feels the opposite one. It is
/// called on the first rank alone.
pub type PairForceFunction = Box<dyn FnMut(&NeighbourList, f64) -> Result<Vec<Vector>, Box<dyn Error>>>;

/// Loads that a user defines.
pub enum UserLoads {
    /// A function of positions. Where its forces are between particles, it may give their part of the stress.
    OfPositions(LoadFunction),
    /// A force between particles whose centres are nearer than a cutoff. Its part of the stress follows from the pairs.
    OfPairs {
        /// The cutoff.
        cutoff: f64,
        /// The force.
        function: PairForceFunction,
    },
}

/// The error of simulations whose particles take no applied loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("user-defined forces are supported for suspensions only")]
pub struct NoLoads;
