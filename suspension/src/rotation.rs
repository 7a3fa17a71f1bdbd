//! Rotation of orientations by the exponential map.
//!
//! With the orientation `q0` at the start of a step, that at a later time is
//!
//! ```text
//! q(t) = exp(r) q0,        r = sum of weights times angular velocities
//! ```
//!
//! Within a step `r` is a sum of vectors like a displacement, so that stages and corrections of all integrators are
//! those of positions. Rotations about different axes do not commute: the Magnus expansion of the exact `r` has, after
//! the integral of the angular velocity `w`, the term `h^3/12 w' x w` (Iserles & Norsett, Phil. Trans. R. Soc. A 357,
//! 983, 1999), which [`add_commutator`] adds and without which the order is 2.
//!
//! In a step of Brownian motion the drift of orientations is that of positions: angular velocities are those at the
//! midpoint, to which orientations are rotated by the drawn motions of the fluid, and the exponential of a random
//! vector has the generator of diffusion on the group of rotations without another drift.

use crate::columns::{self, ORIENTATION, ORIENTATION_NUMBERS, RANDOM_ROTATION, ROTATION};
use domain::{Comm, Particles, Quaternion, Vector};
use hydrodynamics::brownian;

/// Whether particles have orientations.
pub fn is_oriented(particles: &Particles) -> bool {
    particles.columns.iter().any(|column| column.name == ORIENTATION)
}

/// Columns of angular velocities that belong to columns of velocities; `None` without orientations.
pub fn angular<const N: usize>(particles: &Particles, velocities: [&str; N]) -> Option<[&'static str; N]> {
    is_oriented(particles).then(|| velocities.map(columns::angular))
}

/// Rotates by the sum of `weights[k]` times the angular velocities that belong to the velocities in column `k`.
pub fn advance<const N: usize>(particles: &mut Particles, velocities: [&str; N], weights: [f64; N]) {
    if let Some(columns) = angular(particles, velocities) {
        let sums = sums(particles, &columns, &weights);
        rotate(particles, &sums);
    }
}

/// Adds the commutator of a step of a length to its rotations: `1/12 h (h w') x r`, with the derivative at the middle
/// of the polynomial through the angular velocities that belong to `velocities`, at `times` since the start of the
/// step.
pub fn add_commutator(particles: &mut Particles, velocities: &[&str], times: &[f64], step: f64) {
    if !is_oriented(particles) {
        return;
    }
    let columns: Vec<&str> = velocities.iter().map(|name| columns::angular(name)).collect();
    let weights: Vec<f64> = slopes(times, 0.5 * step).into_iter().map(|slope| slope * step * step / 12.0).collect();
    let changes = sums(particles, &columns, &weights);
    let twists: Vec<Vector> =
        changes.iter().zip(particles.vectors(ROTATION)).map(|(change, rotation)| change.cross(*rotation)).collect();
    rotate(particles, &twists);
}

/// Weights of the values at `times` in the derivative at `time` of the polynomial through them.
fn slopes(times: &[f64], time: f64) -> Vec<f64> {
    let slope = |k: usize| {
        let others = || (0..times.len()).filter(move |&j| j != k);
        let without = |i: usize| {
            let factors = others().filter(|&j| j != i).map(|j| (time - times[j]) / (times[k] - times[j]));
            factors.product::<f64>() / (times[k] - times[i])
        };
        others().map(without).sum()
    };
    (0..times.len()).map(slope).collect()
}

/// Ends a step: the present orientations are those at the start of the next.
pub fn end(particles: &mut Particles) {
    particles.columns.retain(|column| ![ROTATION, RANDOM_ROTATION].contains(&column.name.as_str()));
}

/// Weighted sums of columns of vectors.
fn sums(particles: &mut Particles, columns: &[&str], weights: &[f64]) -> Vec<Vector> {
    let mut sums = vec![Vector::ZERO; particles.len()];
    for (name, &weight) in columns.iter().zip(weights) {
        sums.iter_mut().zip(particles.vectors(name).iter()).for_each(|(sum, &w)| *sum += w * weight);
    }
    sums
}

/// Adds vectors to the rotations since the start of the step.
fn rotate(particles: &mut Particles, more: &[Vector]) {
    let before = particles.vectors(ROTATION).to_vec();
    particles.vectors(ROTATION).iter_mut().zip(more).for_each(|(rotation, &more)| *rotation += more);
    for ((orientation, &before), &more) in orientations(particles).iter_mut().zip(&before).zip(more) {
        if !orientation.is_some() {
            continue;
        }
        let start =
            if before == Vector::ZERO { *orientation } else { Quaternion::exp(before).inverse() * *orientation };
        *orientation = (Quaternion::exp(before + more) * start).normalized();
    }
}

/// The orientations as they are; empty without.
pub fn known(particles: &Particles) -> &[Quaternion] {
    let column = particles.columns.iter().find(|column| column.name == ORIENTATION);
    column.map(|column| bytemuck::cast_slice(&column.values)).unwrap_or_default()
}

/// The orientations, to be changed.
pub fn orientations(particles: &mut Particles) -> &mut [Quaternion] {
    bytemuck::cast_slice_mut(&mut particles.column(ORIENTATION, ORIENTATION_NUMBERS).values)
}

/// Largest rotation by sums of `weights[k]` times the angular velocities that belong to column `k`, in radians;
/// infinite if one is NaN, 0 without orientations. Collective.
pub fn largest<const N: usize>(
    particles: &mut Particles,
    velocities: [&str; N],
    weights: [f64; N],
    comm: &Comm,
) -> f64 {
    let Some(columns) = angular(particles, velocities) else { return 0.0 };
    let sums = sums(particles, &columns, &weights);
    let angles = sums.iter().zip(orientations(particles)).filter(|(_, q)| q.is_some()).map(|(sum, _)| sum.length());
    // The maximum of floating-point numbers ignores NaN.
    let mut largest = [angles.fold(0.0, |m, e| if e.is_nan() { f64::INFINITY } else { f64::max(m, e) })];
    comm.max(&mut largest);
    largest[0]
}

/// Stores the rotations by the drawn motions of the fluid over a time.
pub fn store_random(particles: &mut Particles, time: f64) {
    if is_oriented(particles) {
        let rotations: Vec<Vector> =
            brownian::ambient(particles).angular_velocities.into_iter().map(|w| w * time).collect();
        particles.vectors(RANDOM_ROTATION).copy_from_slice(&rotations);
    }
}

/// Limits the angular drift of a step, see [`brownian::limit_angular_drift`].
pub fn limit_drift(particles: &mut Particles, time: f64) {
    if is_oriented(particles) {
        brownian::limit_angular_drift(particles, time);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::{ANGULAR_VELOCITY, VELOCITY};

    const A: Vector = Vector::new(0.7, -0.2, 0.9);
    const B: Vector = Vector::new(-0.4, 1.1, 0.3);

    #[test]
    fn slopes_of_a_cubic_are_exact() {
        let times = [0.0, -0.3, -0.37, 0.4];
        let value = |t: f64| 1.0 + t * (2.0 - t * (3.0 - 5.0 * t));
        let found: f64 = slopes(&times, 0.2).iter().zip(times).map(|(w, t)| w * value(t)).sum();
        assert!((found - (2.0 - 6.0 * 0.2 + 15.0 * 0.04)).abs() < 1e-13, "{found}");
        assert_eq!(slopes(&[0.0, 0.5], 0.1), [-2.0, 2.0]);
        assert_eq!(slopes(&[0.0], 0.1), [0.0]);
    }

    /// Corrections within a step are those of positions: a predicted rotation is taken back and replaced.
    #[test]
    fn a_corrected_rotation_is_the_corrected_one() {
        let mut particles = Particles::default();
        particles.push(0, Vector::ZERO, 1.0, 0);
        orientations(&mut particles)[0] = Quaternion::IDENTITY;
        particles.vectors(ANGULAR_VELOCITY)[0] = A;
        particles.vectors(columns::angular(columns::EXPECTED))[0] = B;
        advance_by(&mut particles, [0.0, 1.0]);
        advance_by(&mut particles, [1.0, -1.0]);
        assert!((orientations(&mut particles)[0].log() - A).length() < 1e-14);
    }

    fn advance_by(particles: &mut Particles, weights: [f64; 2]) {
        super::advance(particles, [VELOCITY, columns::EXPECTED], weights);
    }

    /// Without orientations no column is made.
    #[test]
    fn spheres_without_orientations_do_not_rotate() {
        let mut particles = Particles::default();
        particles.push(0, Vector::ZERO, 1.0, 0);
        particles.vectors(ANGULAR_VELOCITY)[0] = A;
        advance_by(&mut particles, [1.0, 0.0]);
        add_commutator(&mut particles, &[VELOCITY], &[0.0], 1.0);
        store_random(&mut particles, 1.0);
        assert_eq!(particles.columns.len(), 1);
        assert_eq!(largest(&mut particles, [VELOCITY], [1.0], &Comm::alone()).to_bits(), 0.0_f64.to_bits());
    }
}
