//! Why a suspension can't be started.

use crate::gap::Gap;
use crate::step_error::StepError;
use domain::{Failure, PackingError};
use fcm::PlanError;
use lubrication::{BarrierError, PairForceError, RangeError};

/// Why a suspension can't be started.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// No plan computes the fluid.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The gaps at which lubrication is to act.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// Lubrication between these radii.
    #[error("hydrodynamics.lubrication")]
    Lubrication(#[source] PairForceError),
    /// Radii that differ too much for lubrication.
    #[error("hydrodynamics.lubrication {0}")]
    Radii(String),
    /// The repulsion.
    #[error(transparent)]
    Repulsion(#[from] BarrierError),
    /// Spheres overlap.
    #[error("two spheres overlap at the start, by {0}; change [particles], or take fewer or smaller spheres")]
    Overlap(Gap),
    /// No grid carries the flow that is to be drawn.
    #[error("output.fields_every asks for the flow on a grid")]
    Fields(#[source] Failure),
    /// The first velocities.
    #[error(transparent)]
    Step(#[from] StepError),
    /// Spheres that are brought and can't be computed.
    #[error("the spheres of particles.path")]
    Given(#[source] Box<StartError>),
    /// Something that only some ranks know of.
    #[error(transparent)]
    Failed(#[from] Failure),
}

/// Why spheres can't be placed.
#[derive(Debug, thiserror::Error)]
pub enum PlacingError {
    /// No room at random.
    #[error("can't place the spheres of [[species]] at random: {0}")]
    Packing(#[from] PackingError),
    /// The spheres that are brought do not fit the species.
    #[error("{name}: {message}")]
    Given {
        /// Where they are from.
        name: String,
        /// What is wrong with them.
        message: String,
    },
}
