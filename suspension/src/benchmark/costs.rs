//! Measured costs of the parts of an evaluation on this machine.

use super::{BenchmarkCase, BenchmarkError, BenchmarkKind, Spheres, Task};
use domain::Comm;
use fcm::{ComputeDevice, Costs, Fixed, Seconds};

/// Costs of stencils, transforms and pairs on a device of this machine, over those that the planner expects: medians
/// over evaluations at two tolerances.
pub fn measured_costs(device: ComputeDevice, comm: &Comm) -> Result<Costs, BenchmarkError> {
    // Threads share the work of the processor. A card takes more spheres, so that launches are a small part.
    let (particles, threads) = match device {
        ComputeDevice::Cpu => (3200, rayon::current_num_threads()),
        ComputeDevice::Gpu => (50_000, 1),
    };
    let case = BenchmarkCase { particles, volume_fraction: 0.12, size_ratio: 1.0 };
    let spheres = Spheres::random(&case, comm)?;
    let task = |tolerance| Task {
        tolerance,
        kind: BenchmarkKind::All,
        repeats: 9,
        with_error: false,
        fixed: Fixed { device, ..Fixed::default() },
        costs: Costs::default(),
    };
    let mut factors = Costs::default();
    for tolerance in [1e-3, 1e-6] {
        let (plan, seconds) = task(tolerance).times(&spheres, comm)?;
        let found = over_expected(&seconds, threads, &plan.parts(case.particles));
        let mean = |one: f64, other: f64| one * other.sqrt();
        factors = Costs {
            stencils: mean(factors.stencils, found.stencils),
            transforms: mean(factors.transforms, found.transforms),
            pairs: mean(factors.pairs, found.pairs),
        };
    }
    Ok(factors)
}

/// Seconds of the parts of an evaluation by some threads over those that one is expected to take, from 0.01 to 100.
fn over_expected(seconds: &Seconds, threads: usize, expected: &Costs) -> Costs {
    let Seconds { spread, fft, interpolate, near, .. } = *seconds;
    let over = |found: f64, expected: f64| (found * threads as f64 / expected).clamp(0.01, 100.0);
    Costs {
        stencils: over(spread + interpolate, expected.stencils),
        transforms: over(fft, expected.transforms),
        pairs: over(near, expected.pairs),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_times_of_all_threads_over_the_expected_ones() {
        let seconds = Seconds { spread: 1.0, interpolate: 2.0, fft: 0.5, near: 1e9, ..Seconds::default() };
        let expected = Costs { stencils: 6.0, transforms: 0.25, pairs: 1.0 };
        let factors = over_expected(&seconds, 4, &expected);
        assert_eq!(factors, Costs { stencils: 2.0, transforms: 8.0, pairs: 100.0 });
    }
}
