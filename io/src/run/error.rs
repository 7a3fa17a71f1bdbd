//! Why a run can't begin or go on.

use crate::{FileError, SceneError};
use domain::{Failure, Interrupted};
use simulation::SimulationError;
use std::path::PathBuf;
use suspension::LeastRepulsionError;

/// Why a run can't begin or go on.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A file that can't be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A scene that was refused.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A suspension that can't be started.
    #[error(transparent)]
    Suspension(#[from] suspension::StartError),
    /// Grains that can't be started.
    #[error(transparent)]
    Grains(#[from] drivers::StartError),
    /// A simulation that can't go on.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// No least repulsion.
    #[error(transparent)]
    LeastRepulsion(#[from] LeastRepulsionError),
    /// Something that only some ranks know of.
    #[error(transparent)]
    Failed(#[from] Failure),
    /// A request to stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// A scene of a kind that is not advanced in steps.
    #[error("scenes of this kind have no steps")]
    NoSteps,
    /// A folder that can't be used.
    #[error("can't {what} {}", path.display())]
    Folder {
        /// What was tried.
        what: &'static str,
        /// The folder or the file in it.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
    /// A folder that may not be used.
    #[error("{0}")]
    Refused(String),
    /// Problems of a continuum without a solution.
    #[error("{} of {problems} problems have no solution:\n{}", unsolved.len(), unsolved.join("\n"))]
    Unsolved {
        /// Which, and why not.
        unsolved: Vec<String>,
        /// How many problems there are.
        problems: usize,
    },
    /// Too little memory.
    #[error("{remedy}: {missing}")]
    Memory {
        /// What the scene is, and what to change.
        remedy: String,
        /// What it takes and what there is.
        missing: domain::NotEnoughMemory,
    },
}
