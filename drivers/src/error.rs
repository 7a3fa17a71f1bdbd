//! Why a driver's run can't be started.

use crate::ParameterError;
use crate::shear_cell::PackingError;

/// Why a driver's run can't be started.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// More than one process.
    #[error(
        "scenes of grains run in one process, on as many threads as there are cores; start this one without mpirun"
    )]
    Processes,
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Grains that can't be packed.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// Particles from outside that do not fit.
    #[error("{name}")]
    Given {
        /// Where they are from.
        name: String,
        /// What is wrong with them.
        source: ParameterError,
    },
    /// Too little memory for particles from outside.
    #[error("particles.path brings {disks} disks; bring fewer: {missing}")]
    Memory {
        /// How many there are.
        disks: usize,
        /// What they take and what there is.
        missing: domain::NotEnoughMemory,
    },
    /// A state without what a run goes on with.
    #[error("the checkpoint has no progress of disks; start the run anew")]
    State,
}

impl StartError {
    /// Refuses several processes.
    pub(crate) fn unless_alone(comm: &domain::Comm) -> Result<(), Self> {
        if comm.size() == 1 { Ok(()) } else { Err(Self::Processes) }
    }
}
