//! Reasons why a driver's run cannot be started.

use crate::ParameterError;

/// A reason why a driver's run cannot be started.
#[derive(Debug, thiserror::Error)]
pub enum GrainStartError {
    /// More than one process.
    #[error(
        "scenes of grains run in one process, on as many threads as there are cores; start this one without mpirun"
    )]
    Processes,
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Grains that cannot be packed.
    #[error(transparent)]
    Packing(#[from] JammedPacking),
    /// Particles from outside that do not fit.
    #[error("{name}")]
    Given {
        /// Name of their source.
        name: String,
        /// Reason why they are refused.
        source: ParameterError,
    },
    /// Too little memory for particles from outside.
    #[error("particles.path brings {disks} disks; bring fewer: {missing}")]
    Memory {
        /// Number of disks.
        disks: usize,
        /// Memory needed and available.
        missing: domain::NotEnoughMemory,
    },
    /// A state without the data that a run resumes from.
    #[error("the checkpoint has no progress of disks; start afresh")]
    State,
}

impl GrainStartError {
    /// Refuses several processes.
    pub(crate) fn unless_alone(comm: &domain::Comm) -> Result<(), Self> {
        if comm.size() == 1 { Ok(()) } else { Err(Self::Processes) }
    }
}

/// Error of grains that jam in packing, or do not fit at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "grains.solid_fraction is {wanted:.4}; this cell was packed at random up to {reached:.4}: ask for less, or a \
     larger cell"
)]
pub struct JammedPacking {
    /// Solid fraction asked for.
    pub wanted: f64,
    /// Solid fraction reached.
    pub reached: f64,
}
