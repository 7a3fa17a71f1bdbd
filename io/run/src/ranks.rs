//! Number of ranks that a scene can be run on.

use crate::RunError;
use granular::GrainStartError;
use scene::Kind;

/// Refuses more than one rank for scenes of grains.
pub fn check_ranks(kind: &Kind, ranks: usize) -> Result<(), RunError> {
    match kind {
        Kind::Suspension(_) => Ok(()),
        _ if ranks == 1 => Ok(()),
        _ => Err(GrainStartError::Processes.into()),
    }
}
