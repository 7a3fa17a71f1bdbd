//! Motion of particles where the far field is evaluated.

use super::Dynamics;
use super::checks::FARTHEST;
use crate::forces::contacts::{CONTACT_NUMBERS, CONTACTS};
use crate::rotation;
use domain::Particles;

impl Dynamics {
    /// Moves particles to where the far field is evaluated, if nothing else needs their positions in each step: free
    /// spheres without orientations, whose forces are steady or added there. Between steps.
    pub(super) fn move_to_far_field(&mut self, particles: &mut Particles) {
        if particles.are_remote() || !self.moves_remotely(particles) {
            return;
        }
        if let Some(holder) = self.hydrodynamics.holder() {
            particles.move_to(holder);
            self.hydrodynamics.hold_loads(&self.forces.steady_loads(particles), particles);
            // Measures of displacements are those of arranged particles.
            self.hydrodynamics.mobility().follow(self.moving.cell(), particles);
        }
    }

    /// Whether particles move where the far field is evaluated.
    fn moves_remotely(&mut self, particles: &Particles) -> bool {
        self.moves_here_by.is_none()
            && !rotation::is_oriented(particles)
            && !self.forces.need_positions(self.needs_pairs)
            && self.fits_slots(particles)
            && self.hydrodynamics.moves_particles()
    }

    /// Whether the states of contacts, which a run with other spheres may have left, have as many slots as those here.
    fn fits_slots(&self, particles: &Particles) -> bool {
        let width = self.forces.contacts.as_ref().map(|contacts| CONTACT_NUMBERS * contacts.slots());
        let known = particles.columns.iter().find(|column| column.name == CONTACTS);
        width.zip(known).is_none_or(|(width, known)| known.width == width)
    }

    /// Wraps particles into the box at a time where they move. Returns whether they still do: particles that are lost
    /// move here again.
    pub(super) fn wrap_remotely(&mut self, particles: &mut Particles, time: f64) -> bool {
        if !particles.are_remote() {
            return false;
        }
        let stays = self.moves_remotely(particles);
        let Some(holder) = self.hydrodynamics.holder() else { return false };
        let is_wrapped = stays && self.moving.advance_remotely(time, particles, FARTHEST, holder);
        if !is_wrapped {
            particles.move_from(holder);
        }
        is_wrapped
    }
}
