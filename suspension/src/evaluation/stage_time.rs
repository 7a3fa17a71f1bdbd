//! Instants of evaluations, and what their solves took.

use hydrodynamics::Solution;
use simulation::Clock;

/// Statistics of the solve of one evaluation.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Outcome {
    /// Number of iterations for the stresslets.
    pub iterations: usize,
    /// Relative residual of the stresslets.
    pub residual: f64,
}

impl Outcome {
    pub(super) fn of(solved: &Solution) -> Self {
        Self { iterations: solved.iterations, residual: solved.residual }
    }
}

/// Instant of an evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct StageTime {
    /// The clock at the start of its step.
    pub clock: Clock,
    /// Elapsed fraction of the step.
    pub fraction: f64,
    /// Ages of the stored solutions relative to the last of them, whose age of 0 comes first.
    pub ages: Vec<f64>,
    /// Time since the last stored solution.
    pub since_last_solution: f64,
    /// Time over which forces between near spheres are implicit, if they are: they are taken at the velocities of the
    /// solve instead of those in the column [`crate::columns::EXPECTED`].
    pub implicit: Option<f64>,
}

impl StageTime {
    /// The instant after a fraction of a step, with solutions stored at the start of each of the `steps` previous
    /// steps.
    pub fn in_step(clock: &Clock, fraction: f64, steps: u64) -> Self {
        let ages = (0..=steps.min(2)).map(|k| k as f64 * clock.dt()).collect();
        Self { clock: *clock, fraction, ages, since_last_solution: fraction * clock.dt(), implicit: None }
    }
}
