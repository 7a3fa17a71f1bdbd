//! What methods have in common that divide steps into parts.

use crate::dynamics::Dynamics;
use crate::relative_motion::RelativeMotion;
use domain::{Comm, Particles, Vector};

/// The column that says how old the past velocities are, and the past solutions: 0 where there is none.
pub const AGES: &str = "past ages";

/// The column that says how old the third past velocities are: 0 where there are none. Methods that use no more than two have no such
/// column.
pub const OLDEST_AGE: &str = "oldest past age";

/// The column that says how long the next substep may be, as far as errors go.
pub const AHEAD: &str = "next substep";

/// A substep shorter than this part of the clock's step is none.
pub const SHORTEST: f64 = 1e-9;

/// Shares that are whole but for round-off are taken as whole: the same steps are taken whatever the units of time.
const ROUND_OFF: f64 = 1e-9;

/// The longest of equal shares of `rest` that is not longer than `longest`, so that the last one is not a small
/// remainder.
pub fn share(rest: f64, longest: f64) -> f64 {
    rest / (rest / longest - ROUND_OFF).ceil().max(1.0)
}

/// How spheres are moved apart that come nearer than the closest gap that lubrication knows, if it acts. None if they cannot
/// be. Collective.
pub fn moved_apart<const N: usize>(
    approach: &RelativeMotion<N>,
    weights: [f64; N],
    dynamics: &Dynamics,
) -> Option<Vec<Vector>> {
    let Some(range) = dynamics.lubrication() else { return Some(Vec::new()) };
    approach.apart(weights, range.closest(), dynamics.partition().comm())
}

/// The largest displacement over the radius, of displacements that are sums of `weights[k]` times column `k`; infinite
/// where one is no number. Collective.
pub fn largest_displacement<const N: usize>(
    particles: &mut Particles,
    (columns, weights): ([&str; N], [f64; N]),
    comm: &Comm,
) -> f64 {
    let mut sums = vec![Vector::ZERO; particles.len()];
    for (name, weight) in columns.into_iter().zip(weights) {
        sums.iter_mut().zip(particles.vectors(name).iter()).for_each(|(sum, &v)| *sum += v * weight);
    }
    let over_radius = sums.iter().zip(&particles.radii).map(|(sum, a)| sum.length() / a);
    // The maximum of floating-point numbers passes over those that are none.
    let mut largest = [over_radius.fold(0.0, |m, e| if e.is_nan() { f64::INFINITY } else { f64::max(m, e) })];
    comm.max(&mut largest);
    largest[0]
}

/// How old the velocities that substeps go on from, and the solutions that were remembered, are: 0 first. Collective.
pub fn ages(particles: &mut Particles, comm: &Comm) -> Vec<f64> {
    let oldest = particles.columns.iter().find(|column| column.name == OLDEST_AGE);
    let oldest = oldest.and_then(|column| column.values.first()).copied().unwrap_or_default();
    let column = particles.column(AGES, 2).values.get(..2).map_or([0.0; 2], |ages| [ages[0], ages[1]]);
    let mut known = [column[0], column[1], oldest];
    comm.max(&mut known);
    std::iter::once(0.0).chain(known.into_iter().take_while(|&age| age > 0.0)).collect()
}

/// Forgets that there were substeps.
pub fn forget(particles: &mut Particles) {
    particles.columns.retain(|column| ![AGES, OLDEST_AGE, AHEAD].contains(&column.name.as_str()));
}

/// Notes that a substep has passed.
pub fn grow_older(particles: &mut Particles, ages: &[f64], step: f64) {
    let next = [step, ages.get(1).map_or(0.0, |age| age + step)];
    particles.column(AGES, 2).values.chunks_exact_mut(2).for_each(|pair| pair.copy_from_slice(&next));
}

/// The same of the third past velocities, after [`grow_older`].
pub fn grow_oldest(particles: &mut Particles, ages: &[f64], step: f64) {
    let next = ages.get(2).map_or(0.0, |age| age + step);
    particles.column(OLDEST_AGE, 1).values.fill(next);
}
