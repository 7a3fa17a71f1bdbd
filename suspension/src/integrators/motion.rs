//! The motion of particles in a step: the one place where integrators change positions and orientations.

use crate::rotation;
use domain::parallel::{change, mapped, overwrite};
use domain::{Particles, Vector};

/// Moves the particles by the sum of `weights[k]` times the velocities in column `k`, and rotates their orientations,
/// if they have some, by the same sum of angular velocities. Rotations within a step are added as vectors, like
/// displacements, until the step ends: [`end`] or [`end_smooth`].
pub fn advance<const N: usize>(particles: &mut Particles, columns: [&str; N], weights: [f64; N]) {
    particles.displace_by(columns, weights);
    rotation::advance(particles, columns, weights);
}

/// Moves the particles by displacements without rotation, which keep near spheres apart; an empty list stands for none.
pub fn move_apart(particles: &mut Particles, displacements: &[Vector]) {
    change(&mut particles.positions, displacements, |position, &displacement| *position += displacement);
}

/// Ends a step or substep. Its rotations are of order 2 in the step.
pub fn end(particles: &mut Particles) {
    rotation::end(particles);
}

/// Ends a step of a length, in which angular velocities vary smoothly, with the values of `columns` at `times` since
/// its start. Its rotations are of order 4, if the values are.
pub fn end_smooth(particles: &mut Particles, columns: &[&str], times: &[f64], step: f64) {
    rotation::add_commutator(particles, columns, times, step);
    rotation::end(particles);
}

/// Copies a column of velocities into another, and with orientations, that of the angular velocities.
pub fn copy(particles: &mut Particles, from: &str, to: &str) {
    copy_column(particles, from, to);
    if let Some([from, to]) = rotation::angular(particles, [from, to]) {
        copy_column(particles, from, to);
    }
}

fn copy_column(particles: &mut Particles, from: &str, to: &str) {
    let values = std::mem::take(&mut particles.column(from, 3).values);
    overwrite(&mut particles.column(to, 3).values, &values);
    particles.column(from, 3).values = values;
}

/// Stores the weighted sum of columns of velocities in another, which may be one of them; with orientations, that of
/// the angular velocities as well.
pub fn combine(particles: &mut Particles, columns: [&str; 2], weights: [f64; 2], to: &str) {
    store_sum(particles, columns, weights, to);
    if let Some([first, second, to]) = rotation::angular(particles, [columns[0], columns[1], to]) {
        store_sum(particles, [first, second], weights, to);
    }
}

fn store_sum(particles: &mut Particles, columns: [&str; 2], weights: [f64; 2], to: &str) {
    let mut sums = mapped(particles.vectors(columns[0]), |&first| first * weights[0]);
    change(&mut sums, particles.vectors(columns[1]), |sum, &second| *sum += second * weights[1]);
    overwrite(particles.vectors(to), &sums);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::{ANGULAR_VELOCITY, ROTATION, VELOCITY};
    use crate::integrators::adams_bashforth::{AdamsBashforth, advance};
    use crate::rotation::orientations;
    use domain::Quaternion;
    use simulation::Clock;

    /// Vectors of two rotations about different axes: `exp(t A) exp(t B)` has the angular velocity `A + exp(t A) B`.
    const A: Vector = Vector::new(0.7, -0.2, 0.9);
    const B: Vector = Vector::new(-0.4, 1.1, 0.3);

    fn precess(particles: &mut Particles, time: f64) {
        particles.vectors(VELOCITY);
        particles.vectors(ANGULAR_VELOCITY)[0] = A + Quaternion::exp(A * time).rotate(B);
    }

    /// Angle from the exact orientation at `t = 4` after a number of steps.
    fn error(method: AdamsBashforth, steps: u64) -> f64 {
        let start = Quaternion::exp(Vector::new(0.1, 0.2, -1.5));
        let mut particles = Particles::default();
        particles.push(0, Vector::ZERO, 1.0, 0);
        orientations(&mut particles)[0] = start;
        precess(&mut particles, 0.0);
        let mut clock = Clock::at(0, 4.0 / steps as f64);
        for _ in 0..steps {
            let at = |particles: &mut Particles, fraction| {
                precess(particles, clock.time_at(fraction));
                Ok::<(), ()>(())
            };
            advance(&mut particles, clock.dt(), clock.step(), method, at).unwrap();
            clock.tick();
        }
        assert!(particles.columns.iter().all(|column| column.name != ROTATION), "no rotation outlives its step");
        let exact = Quaternion::exp(4.0 * A) * Quaternion::exp(4.0 * B) * start;
        (orientations(&mut particles)[0] * exact.inverse()).log().length()
    }

    /// About a precessing axis, where rotations do not commute; Euler steps with renormalised quaternions have order 1,
    /// and without the commutator all methods have order 2.
    #[test]
    fn errors_fall_with_the_order_of_the_method() {
        for expected in [2, 3, 4] {
            let method = AdamsBashforth::of_order(expected);
            for steps in [100, 200, 400] {
                let order = (error(method, steps) / error(method, 2 * steps)).log2();
                assert!((order - f64::from(expected)).abs() < 0.2, "order {order} of {method:?} from {steps} steps");
            }
        }
    }

    /// A constant angular velocity is exact for any step, for thousands of turns.
    #[test]
    fn a_steady_rotation_is_exact() {
        let mut particles = Particles::default();
        particles.push(0, Vector::ZERO, 1.0, 0);
        particles.push(1, Vector::ZERO, 1.0, 0);
        orientations(&mut particles)[0] = Quaternion::IDENTITY;
        particles.vectors(ANGULAR_VELOCITY).fill(A);
        let turn = std::f64::consts::TAU / A.length();
        let mut clock = Clock::at(0, turn / 7.0);
        for _ in 0..7 * 1000 {
            let still = |_: &mut Particles, _| Ok::<(), ()>(());
            advance(&mut particles, clock.dt(), clock.step(), AdamsBashforth::Four, still).unwrap();
            clock.tick();
        }
        assert!(orientations(&mut particles)[0].log().length() < 1e-10);
        assert_eq!(orientations(&mut particles)[1], Quaternion::NONE);
    }
}
