//! Swimmers in an evaluation and between steps.

use super::Dynamics;
use domain::{Particles, Traceless, Vector};
use hydrodynamics::Squirming;
use simulation::Clock;

impl Dynamics {
    /// Slip modes of this rank's particles; `None` if no sphere has slip.
    pub(super) fn squirming(&self, particles: &Particles) -> Option<Squirming> {
        let swimmers = self.swimmers.as_ref().filter(|swimmers| swimmers.have_slip());
        swimmers.map(|swimmers| swimmers.squirming(particles))
    }

    /// Adds the intrinsic angular velocities of swimmers.
    pub(super) fn add_own_rotation(&self, particles: &Particles, angular_velocities: &mut [Vector]) {
        if let Some(swimmers) = &self.swimmers {
            swimmers.add_own_rotation(particles, angular_velocities);
        }
    }

    /// Changes the directions of swimmers by their noise in the step of a clock.
    pub fn reorient(&self, particles: &mut Particles, clock: &Clock) {
        if let Some(swimmers) = &self.swimmers {
            swimmers.reorient(particles, clock.step());
        }
    }

    /// Stresslets of this rank's particles by their activity; `None` if no sphere has slip.
    pub fn active_stresslets(&self, particles: &Particles) -> Option<Vec<Traceless>> {
        let swimmers = self.swimmers.as_ref().filter(|swimmers| swimmers.have_slip());
        swimmers.map(|swimmers| swimmers.active_stresslets(particles))
    }
}
