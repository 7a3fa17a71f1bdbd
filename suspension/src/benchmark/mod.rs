//! Benchmarks of a mobility: its time and its error for random spheres, and what its parts cost on a machine.

mod costs;
mod measure;
mod spheres;

pub use costs::measured_costs;
pub use measure::{Measurement, Task};
pub use spheres::{Case, Kind, Spheres};

use domain::{BoxError, Failure};
use fcm::PlanError;

/// Why a case can't be measured.
#[derive(Debug, thiserror::Error)]
pub enum BenchmarkError {
    /// The spheres have no place.
    #[error("these spheres can't be placed: {0}")]
    Placing(Failure),
    /// There is no box for them.
    #[error(transparent)]
    Box(#[from] BoxError),
    /// No plan has the tolerance.
    #[error("this case can't be evaluated")]
    Plan(#[source] PlanError),
    /// There is no memory.
    #[error(transparent)]
    Room(#[from] Failure),
}
