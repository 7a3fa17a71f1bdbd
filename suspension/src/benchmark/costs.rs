//! Measured costs of the parts of an evaluation on this machine.

use super::{BenchmarkCase, BenchmarkError, BenchmarkKind, Spheres, Task};
use domain::Comm;
use fcm::{Costs, Fixed, Seconds};

/// Costs of stencils, transforms and pairs on this machine, over those that the planner expects: medians over
/// evaluations at two tolerances.
pub fn measured_costs(comm: &Comm) -> Result<Costs, BenchmarkError> {
    let case = BenchmarkCase { particles: 3200, volume_fraction: 0.12, size_ratio: 1.0 };
    let spheres = Spheres::random(&case, comm)?;
    let task = |tolerance| Task {
        tolerance,
        kind: BenchmarkKind::All,
        repeats: 9,
        with_error: false,
        fixed: Fixed::default(),
        costs: Costs::default(),
    };
    let mut factors = [1.0; 3];
    for tolerance in [1e-3, 1e-6] {
        let (plan, seconds) = task(tolerance).times(&spheres, comm)?;
        let Seconds { spread, fft, interpolate, near, .. } = seconds;
        let expected = plan.parts(case.particles);
        let parts = [(spread + interpolate, expected.stencils), (fft, expected.transforms), (near, expected.pairs)];
        for (factor, (found, expected)) in factors.iter_mut().zip(parts) {
            // Threads share the work.
            let found = found * rayon::current_num_threads() as f64;
            *factor *= (found / expected).clamp(0.01, 100.0).sqrt();
        }
    }
    let [stencils, transforms, pairs] = factors;
    Ok(Costs { stencils, transforms, pairs })
}
