//! Record of solutions in columns of the particles.

use super::Dynamics;
use crate::columns::{ANGULAR_VELOCITY, STRESSLET, VELOCITY};
use domain::parallel::{FusedLoops, of_rows, stage};
use domain::{Particles, Vector};
use hydrodynamics::Solution;

impl Dynamics {
    /// Writes a solution into the particles' columns. Angular velocities include the background flow; velocities
    /// include it unless they are relative to it while particles move.
    pub(super) fn record(&self, particles: &mut Particles, solved: &Solution) {
        let _stage = stage("record of the solution");
        if let Some(columns) = solved.kept.as_ref().map(|kept| &kept.columns)
            && let Some([velocities, angular_velocities]) = &columns.moving
        {
            particles.column(VELOCITY, 3).values = velocities.clone();
            particles.column(ANGULAR_VELOCITY, 3).values = angular_velocities.clone();
            particles.column(STRESSLET, 5).values = columns.stresslets.clone();
            self.warm_start.record(particles, solved);
            return;
        }
        self.note_carried(particles, VELOCITY, &solved.motion.velocities);
        if self.rigid {
            let mut turned = self.with_rotation_of_flow(particles, &solved.motion.angular_velocities);
            self.add_own_rotation(particles, &mut turned);
            if let Some(kept) = &solved.kept {
                particles.column(ANGULAR_VELOCITY, 3).values = bytemuck::cast_slice(&turned).to_vec().into();
                particles.column(STRESSLET, 5).values = kept.columns.stresslets.clone();
                self.warm_start.record(particles, solved);
                return;
            }
            self.fetch(particles);
            let [angular_velocities, stresslets] = particles.columns_of([ANGULAR_VELOCITY, STRESSLET], [3, 5]);
            let mut loops = FusedLoops::default();
            loops.copied(angular_velocities, bytemuck::cast_slice(&turned));
            loops.copied(stresslets, bytemuck::cast_slice(&solved.stresslets));
            loops.run();
            self.record_bodies(particles, solved);
            self.warm_start.record(particles, solved);
        }
    }

    /// Writes velocities into a column, with the background flow that columns of velocities contain.
    pub(super) fn note_carried(&self, particles: &mut Particles, column: &str, velocities: &[Vector]) {
        let (moving, positions, radii) = (&self.moving, &particles.positions, &particles.radii);
        let carried = |row: usize| velocities[row] + moving.carried_velocity_of(positions[row], radii[row]);
        let carried = of_rows(velocities.len(), |row| carried(row).to_array());
        particles.column(column, 3).values = carried.into_flattened().into();
    }
}
