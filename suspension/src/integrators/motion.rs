//! The motion of particles in a step: the one place where integrators change positions.

use domain::{Particles, Vector};

/// Moves the particles by the sum of `weights[k]` times the velocities in column `k`. A property that moves with the
/// particles by their angular velocities, such as an orientation, is to be rotated here with the same weights.
pub fn advance<const N: usize>(particles: &mut Particles, columns: [&str; N], weights: [f64; N]) {
    particles.displace_by(columns, weights);
}

/// Moves the particles by displacements without rotation, which keep near spheres apart; an empty list stands for none.
pub fn move_apart(particles: &mut Particles, displacements: &[Vector]) {
    particles.positions.iter_mut().zip(displacements).for_each(|(position, &displacement)| *position += displacement);
}
