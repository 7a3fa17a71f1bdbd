//! Errors at the start of a suspension.

pub mod gap;
pub mod step;

use crate::error::gap::Gap;
use crate::error::step::StepError;
use domain::{Failure, PackingError};
use fcm::PlanError;
use lubrication::{BarrierError, PairForceError, RangeError};

/// Error at the start of a suspension.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// No plan of the far field fits the problem.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Invalid gaps for lubrication.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// No lubrication functions for these radii.
    #[error("hydrodynamics.lubrication")]
    Lubrication(#[source] PairForceError),
    /// Radii that differ too much for lubrication.
    #[error("hydrodynamics.lubrication {0}")]
    Radii(String),
    /// Invalid repulsion.
    #[error(transparent)]
    Repulsion(#[from] BarrierError),
    /// Spheres overlap.
    #[error("two spheres overlap at the start, by {0}; change [particles], or take fewer or smaller spheres")]
    Overlap(Gap),
    /// No grid can resolve the velocity field that is to be written.
    #[error("output.fields_every asks for the flow on a grid")]
    Fields(#[source] Failure),
    /// The first evaluation failed.
    #[error(transparent)]
    Step(#[from] StepError),
    /// Spheres from elsewhere that cannot be computed.
    #[error("the spheres of particles.path")]
    Given(#[source] Box<StartError>),
    /// An error that may be known to some ranks only.
    #[error(transparent)]
    Failed(#[from] Failure),
}

/// Error of the initial placement of spheres.
#[derive(Debug, thiserror::Error)]
pub enum PlacingError {
    /// Random placement found no room.
    #[error("can't place the spheres of [[species]] at random: {0}")]
    Packing(#[from] PackingError),
    /// Random placement of bodies found no room.
    #[error("can't place [[bodies]]: {0}")]
    NoRoom(String),
    /// Spheres from elsewhere that do not match the species.
    #[error("{name}: {message}")]
    Given {
        /// Their source.
        name: String,
        /// Description of the mismatch.
        message: String,
    },
}
