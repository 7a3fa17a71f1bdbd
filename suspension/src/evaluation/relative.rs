//! Motions relative to the background flow.

use super::Dynamics;
use crate::bodies;
use crate::columns::{self, EXPECTED, VELOCITY};
use domain::parallel::{change_rows, copied};
use domain::{ColumnValues, Particles, Vector};

impl Dynamics {
    /// A column of velocities minus the background flow, as far as the column contains it.
    pub(super) fn relative(&self, particles: &mut Particles, name: &str) -> Vec<Vector> {
        let mut velocities = copied(particles.vectors(name));
        let (moving, positions, radii) = (&self.moving, &particles.positions, &particles.radii);
        change_rows(&mut velocities, |row, v| *v -= moving.carried_velocity_of(positions[row], radii[row]));
        velocities
    }

    /// Predicted angular velocities relative to the background flow, and without those of swimmers by themselves; empty
    /// without bonds that resist bending.
    pub(super) fn relative_rotation(&self, particles: &mut Particles) -> Vec<Vector> {
        if !self.forces.have_beams() {
            return Vec::new();
        }
        let expected = columns::angular(EXPECTED);
        let mut own = self.with_rotation_of_flow(particles, &vec![Vector::ZERO; particles.len()]);
        self.add_own_rotation(particles, &mut own);
        particles.vectors(expected).iter().zip(own).map(|(&expected, own)| expected - own).collect()
    }

    /// Adds `times` the flow relative to which velocities are given while particles move.
    pub(super) fn add_background(&self, particles: &mut Particles, times: f64) {
        if !self.moving.advects() {
            return;
        }
        let flow = self.flow();
        if let Some(positions) = particles.positions.remote_list().cloned() {
            let velocities = self.held_column(particles, VELOCITY, 3);
            let summed = self.steps().with_flow(&velocities, &positions, flow, times);
            particles.set_column(VELOCITY, 3, ColumnValues::remote(summed));
            return;
        }
        let mut velocities = std::mem::take(&mut particles.column(VELOCITY, 3).values);
        let positions = &particles.positions;
        let vectors: &mut [Vector] = bytemuck::cast_slice_mut(&mut velocities);
        change_rows(vectors, |row, v| *v += flow.velocity(positions[row]) * times);
        particles.column(VELOCITY, 3).values = velocities;
        bodies::add_at_centres(particles, |x| flow.velocity(x) * times);
    }
}
