//! Benchmarks of the mobility: time and error for random spheres, and costs of its parts on a machine.

mod costs;
mod machine;
mod measure;
mod network;
mod shares;
mod spheres;

pub use costs::measured_costs;
pub use machine::measured_machine;
pub use measure::{CostMeasurement, Stages, Task};
pub use network::measured_network;
pub use shares::Shares;
pub use spheres::{BenchmarkCase, BenchmarkKind, Spheres};

use domain::{BoxError, Failure};
use fcm::PlanError;

/// Error of a benchmark.
#[derive(Debug, thiserror::Error)]
pub enum BenchmarkError {
    /// The spheres cannot be placed.
    #[error("these spheres can't be placed: {0}")]
    Placing(Failure),
    /// There is no box for the spheres.
    #[error(transparent)]
    Box(#[from] BoxError),
    /// No plan reaches the tolerance.
    #[error("this case can't be evaluated")]
    Plan(#[source] PlanError),
    /// There is not enough memory.
    #[error(transparent)]
    Room(#[from] Failure),
}
