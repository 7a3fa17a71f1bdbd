//! The box of particles that move in a remote memory.

use super::PeriodicCell;
use crate::columns::are_velocities;
use domain::{Particles, RemoteFrame, RemoteHolder};
use solver::BackgroundFlow;

impl PeriodicCell {
    /// [`Self::advance_to`] for particles in a remote memory, in a flow that does not advect them. Returns `false`,
    /// with no effect, if the lattice vectors of the box change, or if a particle is farther from it than some edges.
    pub fn advance_remotely(
        &mut self,
        time: f64,
        particles: &mut Particles,
        farthest: f64,
        holder: &dyn RemoteHolder,
    ) -> bool {
        let (cell, vectors) = self.shape_at(time);
        if vectors != self.vectors {
            return false;
        }
        let (is_flowing, gradient) = (self.flow != BackgroundFlow::NONE, self.flow.gradient());
        let frame = RemoteFrame { cell: &cell, gradient, farthest };
        let is_moved = particles.advance_remotely(frame, |name| is_flowing && are_velocities(name), holder);
        if is_moved {
            (self.time, self.cell) = (time, cell);
        }
        is_moved
    }
}
