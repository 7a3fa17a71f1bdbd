//! Errors of mobilities.

use super::Overlaps;
use crate::ambient::FlowRefused;
use domain::Failure;
use fcm::{OutsideError, PlanError, SolveError};
use lubrication::PairForceError;

/// Error of a mobility.
#[derive(Debug, thiserror::Error)]
pub enum MobilityError {
    /// No plan fits the problem.
    #[error("this case can't be evaluated")]
    Plan(#[source] PlanError),
    /// Slip of spheres without a far field of it.
    #[error("swimming needs rigid spheres with dipoles, and the processors of the host as the device")]
    Swimming,
    /// Slip in a mobility that was planned without it.
    #[error("slip is given, but swimming is false; set it to true")]
    NotSwimming,
    /// Given motions of another number of bodies.
    #[error("motions of {found} bodies are given, but there are {count} bodies; give one for each")]
    GivenMotions {
        /// Number of given motions.
        found: usize,
        /// Number of bodies.
        count: usize,
    },
    /// A radius out of its range.
    #[error("radii has a sphere whose radius {0}")]
    Radius(String),
    /// A box too elongated for random motions.
    #[error("box {0}")]
    Box(String),
    /// No lubrication functions for these radii.
    #[error(transparent)]
    Lubrication(#[from] PairForceError),
    /// Overlapping spheres with lubrication.
    #[error("{0}; lubrication acts between spheres that are apart: move these apart, or leave out lubrication")]
    Overlap(Overlaps),
    /// A sphere outside of a box with walls or open faces.
    #[error(transparent)]
    Outside(#[from] OutsideError),
    /// A background flow that is incompatible with the walls.
    #[error(transparent)]
    Flow(#[from] FlowRefused),
    /// The square root did not converge.
    #[error(
        "the square root of the mobility still changed by {change:.1e} after {applications} applications, where \
         {tolerance:e} was asked for: move spheres that nearly touch apart, or take a larger tolerance"
    )]
    Root {
        /// Number of applications of the mobility.
        applications: usize,
        /// Last change, relative to the root.
        change: f64,
        /// Allowed change.
        tolerance: f64,
    },
    /// The solve failed.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// An error that may be known to some ranks only.
    #[error(transparent)]
    Failed(#[from] Failure),
}
