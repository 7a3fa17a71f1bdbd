//! Errors of starting or continuing a run.

use domain::{Failure, Interrupted};
use files::FileError;
use scene::SceneError;
use simulation::SimulationError;
use std::path::PathBuf;
use suspension::LeastRepulsionError;

/// Reasons why a run cannot begin or continue.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A file that cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A scene that was refused.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A suspension that cannot be started.
    #[error(transparent)]
    Suspension(#[from] suspension::StartError),
    /// Grains that cannot be started.
    #[error(transparent)]
    Grains(#[from] granular::GrainStartError),
    /// A simulation that cannot continue.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// No strength of repulsion prevents overlaps.
    #[error(transparent)]
    LeastRepulsion(#[from] LeastRepulsionError),
    /// Something that only some ranks know of.
    #[error(transparent)]
    Failed(#[from] Failure),
    /// A request to stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// A state that cannot be continued.
    #[error(
        "{}: the scene can't be continued from this checkpoint; move it away to go on from the one before, or start \
         the run afresh",
        file.display()
    )]
    Checkpoint {
        /// File of the checkpoint.
        file: PathBuf,
        /// Cause.
        source: granular::GrainStartError,
    },
    /// A scene of a kind that is not advanced in steps.
    #[error("scenes of this kind have no steps")]
    NoSteps,
    /// A folder that cannot be used.
    #[error("can't {what} {}", path.display())]
    Folder {
        /// The failed action.
        what: &'static str,
        /// Path of the folder or the file in it.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// A folder that must not be used.
    #[error("{0}")]
    Refused(String),
    /// Problems of a continuum without a solution.
    #[error("{} of {problems} problems have no solution:\n{}", unsolved.len(), unsolved.join("\n"))]
    Unsolved {
        /// Each problem without a solution, and the reason.
        unsolved: Vec<String>,
        /// Number of problems.
        problems: usize,
    },
    /// Too little memory.
    #[error("{remedy}: {missing}")]
    Memory {
        /// Description of the scene, and advice.
        remedy: String,
        /// Memory needed and available.
        missing: domain::NotEnoughMemory,
    },
}
