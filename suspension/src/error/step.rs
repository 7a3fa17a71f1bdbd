//! Errors of a step.

use crate::error::gap::Gap;
use domain::{Failure, Interrupted};
use fcm::SolveError;

/// Error of a step.
#[derive(Debug, thiserror::Error)]
pub enum StepError {
    /// A position that is not finite or far away.
    #[error("{0}")]
    NotFinite(Failure),
    /// A sphere that was driven into a wall.
    #[error("{0}")]
    IntoWall(Failure),
    /// No grid fits the box that follows the spheres.
    #[error("step {step}: the box that follows the spheres has edges of {edges} now; {source}")]
    Box {
        /// Number of steps taken before.
        step: u64,
        /// Edges of the box.
        edges: String,
        /// Cause.
        source: Failure,
    },
    /// Near pairs that approach faster than steps can resolve.
    #[error(
        "step {step}: two spheres {gap} apart come together faster than any time step can follow; give the scene a \
         [repulsion], or a larger repulsion.strength, or hydrodynamics.lubrication = true, or time.integrator = \
         \"adams-bashforth\", which lets spheres overlap"
    )]
    Collision {
        /// Number of steps taken before.
        step: u64,
        /// The smallest gap.
        gap: Gap,
    },
    /// More contacts of a sphere than possible.
    #[error("{0}; spheres overlap by far: give a larger contacts.stiffness or a shorter time.step")]
    Contacts(Failure),
    /// A bond that is too long.
    #[error("step {step}: {source}")]
    Bonds {
        /// Number of steps taken before.
        step: u64,
        /// The bond and its limit.
        source: Failure,
    },
    /// A failed solve with overlapping spheres.
    #[error(
        "step {step}: spheres overlap by {overlap}, and the flow around them can't be found; take a smaller time.step, \
         a larger repulsion.strength, or time.integrator = \"adaptive\", which keeps spheres apart"
    )]
    Overlap {
        /// Number of steps taken before.
        step: u64,
        /// The largest overlap.
        overlap: Gap,
    },
    /// A failed solve.
    #[error("step {step}")]
    Solve {
        /// Number of steps taken before.
        step: u64,
        /// Cause.
        source: SolveError,
    },
    /// Magnetic or electric moments that were not found.
    #[error("step {step}: {source}")]
    Moments {
        /// Number of steps taken before.
        step: u64,
        /// Reason.
        source: Failure,
    },
    /// User-defined loads that failed or are invalid.
    #[error("step {step}: a force of one's own: {source}")]
    Applied {
        /// Number of steps taken before.
        step: u64,
        /// Error of the function, or description of the invalid loads.
        source: Failure,
    },
    /// Some rank was asked to stop.
    #[error("the step was interrupted")]
    Interrupted(#[from] Interrupted),
}
