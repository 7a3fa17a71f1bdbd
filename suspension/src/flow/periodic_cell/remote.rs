//! The box of particles that move in a remote memory.

use super::PeriodicCell;
use crate::columns::are_velocities;
use crate::flow::deformation::Deformation;
use domain::{Particles, RemoteFrame, RemoteHolder};
use fcm::MovingFlow;
use solver::BackgroundFlow;

impl PeriodicCell {
    /// [`Self::advance_to`] for particles in a remote memory, at a given rate. Returns `false`, with no effect, if a
    /// particle is farther from the box than some edges.
    pub fn advance_remotely(
        &mut self,
        time: f64,
        particles: &mut Particles,
        farthest: f64,
        holder: &dyn RemoteHolder,
    ) -> bool {
        let (cell, vectors) = self.shape_at(time);
        let (carried, deformation) = (self.moving_flow().carried, self.deformation_to(time));
        let frame = RemoteFrame {
            cell: &cell,
            gradient: carried.gradient(),
            deformation: deformation.tensor(),
            renaming: self.renamed(vectors),
            farthest,
        };
        let changes = carried != BackgroundFlow::NONE || deformation != Deformation::NONE;
        let is_moved = particles.advance_remotely(frame, |name| changes && are_velocities(name), holder);
        if is_moved {
            (self.time, self.cell, self.vectors) = (time, cell, vectors);
            self.set_rate_at(time);
        }
        is_moved
    }

    /// The flow, with the part of it that velocities contain while particles move.
    pub fn moving_flow(&self) -> MovingFlow {
        let carried = if self.advects() { BackgroundFlow::NONE } else { self.flow };
        MovingFlow { flow: self.flow, carried }
    }
}
