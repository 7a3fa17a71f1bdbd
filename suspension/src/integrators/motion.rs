//! The motion of particles in a step: the one place where integrators change positions and orientations.

use crate::evaluation::Dynamics;
use crate::evaluation::approach::Separated;
use crate::{bodies, rotation};
use domain::parallel::{change, of_rows};
use domain::{ColumnValues, Particles};

/// Moves the particles by the sum of `weights[k]` times the velocities in column `k`, and rotates their orientations,
/// if they have some, by the same sum of angular velocities. Rotations within a step are added as vectors, like
/// displacements, until the step ends: [`end`] or [`end_smooth`]. Spheres of a rigid body move with its centre and
/// its rotation.
pub fn advance<const N: usize>(particles: &mut Particles, columns: [&str; N], weights: [f64; N]) {
    let arms = bodies::arms(particles);
    match bodies::centres(particles, columns) {
        Some(of_centres) => particles.displace_by(of_centres, weights),
        None => particles.displace_by(columns, weights),
    }
    rotation::advance(particles, columns, weights);
    bodies::swing(particles, &arms);
}

/// Moves the particles by displacements without rotation, which keep near spheres apart. All spheres of a rigid body
/// have the same displacement.
pub fn move_apart(particles: &mut Particles, separated: Separated) {
    match separated {
        Separated::Apart => {}
        Separated::Here(displacements) => {
            change(&mut particles.positions, &displacements, |position, &displacement| *position += displacement);
        }
        Separated::Held(displacements) => particles.displace_remotely(displacements),
    }
}

/// Ends a step or substep. Its rotations are of order 2 in the step.
pub fn end(particles: &mut Particles) {
    rotation::end(particles);
}

/// Ends a step of a length, in which angular velocities vary smoothly, with the values of `columns` at `times` since
/// its start. Its rotations are of order 4, if the values are.
pub fn end_smooth(particles: &mut Particles, columns: &[&str], times: &[f64], step: f64) {
    let arms = bodies::arms(particles);
    rotation::add_commutator(particles, columns, times, step);
    bodies::swing(particles, &arms);
    rotation::end(particles);
}

/// Copies a column of velocities into another; with orientations, that of the angular velocities, and with bodies, that
/// of the velocities of centres as well.
pub fn copy(particles: &mut Particles, from: &str, to: &str) {
    copy_column(particles, from, to);
    for [from, to] in accompanying(particles, [from, to]).into_iter().flatten() {
        copy_column(particles, from, to);
    }
}

/// Columns that belong to columns of velocities and change with them, as far as they exist.
fn accompanying<const N: usize>(particles: &Particles, columns: [&str; N]) -> [Option<[&'static str; N]>; 2] {
    [rotation::angular(particles, columns), bodies::centres(particles, columns)]
}

/// Exchanges two columns of velocities, and the columns that [`copy`] copies.
pub fn exchange(particles: &mut Particles, one: &str, other: &str) {
    let others = accompanying(particles, [one, other]);
    for [one, other] in std::iter::once([one, other]).chain(others.into_iter().flatten()) {
        let first = std::mem::take(&mut particles.column(one, 3).values);
        let second = std::mem::replace(&mut particles.column(other, 3).values, first);
        particles.column(one, 3).values = second;
    }
}

fn copy_column(particles: &mut Particles, from: &str, to: &str) {
    let values = particles.column(from, 3).values.clone();
    particles.column(to, 3).values = values;
}

/// Stores the weighted sum of columns of velocities in another, which may be one of them, and those of the columns that
/// [`copy`] copies.
pub fn combine(particles: &mut Particles, columns: [&str; 2], weights: [f64; 2], to: &str, dynamics: &Dynamics) {
    match dynamics.held_sum(particles, columns, weights) {
        Some(list) => particles.set_column(to, 3, ColumnValues::remote(list)),
        None => combine_here(particles, columns, weights, to),
    }
}

/// [`combine`] for particles that move here.
fn combine_here(particles: &mut Particles, columns: [&str; 2], weights: [f64; 2], to: &str) {
    store_sum(particles, columns, weights, to);
    for [first, second, to] in accompanying(particles, [columns[0], columns[1], to]).into_iter().flatten() {
        store_sum(particles, [first, second], weights, to);
    }
}

fn store_sum(particles: &mut Particles, columns: [&str; 2], weights: [f64; 2], to: &str) {
    for name in columns {
        particles.vectors(name);
    }
    let [first, second] = columns.map(|name| particles.rows::<3>(name).expect("a column of vectors"));
    let sum = |row: usize| [0, 1, 2].map(|axis| first[row][axis] * weights[0] + second[row][axis] * weights[1]);
    particles.column(to, 3).values = of_rows(particles.len(), sum).into_flattened().into();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::{ANGULAR_VELOCITY, ARM, BODY, EXPECTED, PAST, ROTATION, VELOCITY};
    use crate::integrators::adams_bashforth::{AdamsBashforth, advance};
    use crate::rotation::orientations;
    use domain::{Quaternion, Vector};
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
            let mut at = |particles: &mut Particles, fraction| {
                precess(particles, clock.time_at(fraction));
                Ok::<(), ()>(())
            };
            advance(&mut particles, clock.dt(), clock.step(), method, &mut at).unwrap();
            at(&mut particles, 1.0).unwrap();
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
            let mut still = |_: &mut Particles, _| Ok::<(), ()>(());
            advance(&mut particles, clock.dt(), clock.step(), AdamsBashforth::Four, &mut still).unwrap();
            clock.tick();
        }
        assert!(orientations(&mut particles)[0].log().length() < 1e-10);
        assert_eq!(orientations(&mut particles)[1], Quaternion::NONE);
    }

    /// Two spheres of a body, and one that is free.
    fn pair() -> Particles {
        let mut particles = Particles::default();
        for id in 0..3 {
            particles.push(id, Vector::ZERO, 1.0, 0);
        }
        particles.column(BODY, 1).values = vec![0.0, 0.0, -1.0].into();
        particles.vectors(ARM).copy_from_slice(&[Vector::Z, -Vector::Z, Vector::ZERO]);
        let start = Quaternion::exp(Vector::new(0.3, -0.2, 1.0));
        orientations(&mut particles).copy_from_slice(&[start, start, Quaternion::NONE]);
        particles.positions = bodies::arms(&mut particles).into();
        particles
    }

    /// Velocities of a body whose centre has the velocity `v`, and which rotates by `w`.
    fn set_motion(particles: &mut Particles, [v, w]: [Vector; 2]) {
        let arms = bodies::arms(particles);
        let velocities: Vec<Vector> = arms.iter().map(|&arm| v + w.cross(arm)).collect();
        particles.vectors(VELOCITY).copy_from_slice(&velocities);
        particles.vectors(ANGULAR_VELOCITY).fill(w);
        bodies::store_centres(particles, None);
    }

    #[test]
    fn centres_move_and_spheres_follow_the_rotation() {
        let mut particles = pair();
        let (v, w) = (Vector::new(1.0, 2.0, -0.5), Vector::new(0.4, 0.3, -2.0));
        set_motion(&mut particles, [v, w]);
        copy(&mut particles, VELOCITY, PAST[0]);
        combine_here(&mut particles, [VELOCITY, PAST[0]], [2.0, -1.0], EXPECTED);
        let turned = Quaternion::exp(w * 3.0) * orientations(&mut particles)[0];
        super::advance(&mut particles, [EXPECTED, PAST[0]], [2.0, 1.0]);
        for (row, arm) in [Vector::Z, -Vector::Z].into_iter().enumerate() {
            let expected = v * 3.0 + turned.rotate(arm);
            assert!((particles.positions[row] - expected).length() < 1e-14, "{:?}", particles.positions[row]);
        }
        assert!((particles.positions[2] - v * 3.0).length() < 1e-14);
    }

    /// Steps of any length, of velocities of any kind, taken back in part, keep the distance.
    #[test]
    fn bodies_are_rigid_whatever_moves_them() {
        let mut particles = pair();
        for step in 0..500 {
            let phase = f64::from(step);
            let motion_now = [Vector::new(phase.sin(), 1.0, 0.2), Vector::new(1.0, (0.3 * phase).cos(), 0.7)];
            set_motion(&mut particles, motion_now);
            super::advance(&mut particles, [VELOCITY, PAST[0]], [0.9, -0.4]);
            copy(&mut particles, VELOCITY, PAST[0]);
            end(&mut particles);
        }
        let distance = (particles.positions[0] - particles.positions[1]).length();
        assert!((distance - 2.0).abs() < 1e-12, "{distance}");
    }
}
