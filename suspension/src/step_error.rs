//! Why a step could not be taken.

use crate::gap::Gap;
use domain::{Failure, Interrupted};
use fcm::SolveError;

/// Why a step could not be taken.
#[derive(Debug, thiserror::Error)]
pub enum StepError {
    /// A position that is no place.
    #[error("{0}")]
    NotFinite(Failure),
    /// A sphere that has sunk into a wall.
    #[error("{0}")]
    IntoWall(Failure),
    /// No grid for where the spheres have gone.
    #[error("step {step}: the box that follows the spheres has edges of {edges} now; {source}")]
    Box {
        /// Steps taken before.
        step: u64,
        /// Its edges.
        edges: String,
        /// Why there is no grid for it.
        source: Failure,
    },
    /// Near pairs come together faster than steps can follow.
    #[error(
        "step {step}: two spheres {gap} apart come together faster than any time step can follow; give the scene a \
         [repulsion], or a larger repulsion.strength, or hydrodynamics.lubrication = true, or time.integrator = \
         \"adams-bashforth\", which lets spheres overlap"
    )]
    Collision {
        /// Steps taken before.
        step: u64,
        /// The smallest gap.
        gap: Gap,
    },
    /// More contacts of a sphere than there can be.
    #[error("{0}; spheres overlap by far: give a larger contacts.stiffness or a shorter time.step")]
    Contacts(Failure),
    /// A bond that is too long.
    #[error("step {step}: {source}")]
    Bonds {
        /// Steps taken before.
        step: u64,
        /// Which one, and how long it may be.
        source: Failure,
    },
    /// The fluid could not be computed around spheres that overlap.
    #[error(
        "step {step}: spheres overlap by {overlap}, and the flow around them can't be found; take a smaller time.step, \
         a larger repulsion.strength, or time.integrator = \"adaptive\", which keeps spheres apart"
    )]
    Overlap {
        /// Steps taken before.
        step: u64,
        /// The largest overlap.
        overlap: Gap,
    },
    /// The fluid could not be computed.
    #[error("step {step}")]
    Solve {
        /// Steps taken before.
        step: u64,
        /// Why not.
        source: SolveError,
    },
    /// Loads that the user adds could not be computed, or are none.
    #[error("step {step}: a force of one's own: {source}")]
    Applied {
        /// Steps taken before.
        step: u64,
        /// What the function said, or what is wrong with its loads.
        source: Failure,
    },
    /// Some rank was asked to stop.
    #[error("the step was interrupted")]
    Interrupted(#[from] Interrupted),
}
