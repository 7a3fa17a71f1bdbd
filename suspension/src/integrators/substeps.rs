//! Common parts of the integrators with substeps.

use crate::evaluation::Dynamics;
use crate::evaluation::approach::{Approach, Separated};
use crate::scalars::{AGES, OLDEST_AGE};
use domain::parallel::{change, greatest, of_rows};
use domain::{Comm, Particles, Scalars, Vector};

/// Smallest substep, over the clock's step.
pub const SHORTEST: f64 = 1e-9;

/// Tolerance for quotients that are integers up to round-off, so that the steps do not depend on the unit of time.
const ROUND_OFF: f64 = 1e-9;

/// Divides `rest` evenly into steps not longer than `longest`, so that no small remainder is left at the end.
pub fn share(rest: f64, longest: f64) -> f64 {
    rest / (rest / longest - ROUND_OFF).ceil().max(1.0)
}

/// Displacements that separate spheres closer than the minimum gap of lubrication, if there is lubrication. `None` if
/// they cannot be separated. Collective.
pub fn moved_apart<const N: usize>(
    approach: &Approach<N>,
    weights: [f64; N],
    dynamics: &Dynamics,
) -> Option<Separated> {
    let Some(range) = dynamics.lubrication() else { return Some(Separated::Apart) };
    approach.apart(weights, range.minimum_gap(), dynamics.partition().comm())
}

/// Largest displacement over the radius, for displacements that are sums of `weights[k]` times column `k`; infinite if
/// one is NaN. Collective.
pub fn largest_displacement<const N: usize>(
    particles: &mut Particles,
    columns: [&str; N],
    weights: [f64; N],
    dynamics: &Dynamics,
) -> f64 {
    if let Some(largest) = dynamics.held_displacement(particles, columns, weights) {
        return largest;
    }
    largest_displacement_here(particles, columns, weights, dynamics.partition().comm())
}

/// [`largest_displacement`] for particles that move here. Collective.
pub fn largest_displacement_here<const N: usize>(
    particles: &mut Particles,
    columns: [&str; N],
    weights: [f64; N],
    comm: &Comm,
) -> f64 {
    let mut sums = of_rows(particles.len(), |_| Vector::ZERO);
    for (name, weight) in columns.into_iter().zip(weights) {
        change(&mut sums, particles.vectors(name), |sum, &v| *sum += v * weight);
    }
    let over_radius = of_rows(sums.len(), |row| sums[row].length() / particles.radii[row]);
    // The maximum of floating-point numbers ignores NaN.
    let mut largest = [greatest(&over_radius, |&over| if over.is_nan() { f64::INFINITY } else { over })];
    comm.max(&mut largest);
    largest[0]
}

/// Ages of the stored velocities and solutions, in ascending order from 0.
pub fn ages(scalars: &Scalars) -> Vec<f64> {
    let [last, before] = scalars.numbers(AGES).unwrap_or_default();
    let [oldest] = scalars.numbers(OLDEST_AGE).unwrap_or_default();
    std::iter::once(0.0).chain([last, before, oldest].into_iter().take_while(|&age| age > 0.0)).collect()
}

/// Updates the ages after a substep.
pub fn grow_older(scalars: &mut Scalars, ages: &[f64], step: f64) {
    scalars.set(AGES, &[step, ages.get(1).map_or(0.0, |age| age + step)]);
}

/// Updates the age of the third past velocities, after [`grow_older`].
pub fn grow_oldest(scalars: &mut Scalars, ages: &[f64], step: f64) {
    scalars.set(OLDEST_AGE, &[ages.get(2).map_or(0.0, |age| age + step)]);
}
