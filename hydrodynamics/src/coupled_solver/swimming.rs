//! Ambient motions by the slip of squirmers.

use crate::coupled_solver::CoupledSolver;
use crate::solution::SolveInput;
use domain::{Particles, PeriodicBox};
use fcm::Motion;

impl CoupledSolver {
    /// Ambient motions of an input and those by the slip of its squirmers: of the fluid by their degenerate
    /// quadrupoles, and their own. `None` without squirmers. Arranges the particles in the mobility. Collective.
    ///
    /// # Panics
    /// If [`crate::Squirming::check`] refuses the plan.
    pub(super) fn swimming(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        acting: &SolveInput,
    ) -> Option<Motion> {
        let squirming = acting.squirming?;
        if !self.partition.comm().any(!squirming.is_empty()) {
            return None;
        }
        let mobility = self.far.mobility();
        mobility.constrain(None);
        mobility.follow(cell, particles);
        let quadrupoles = squirming.quadrupoles(mobility.plan().viscosity, &particles.radii);
        let mut motion = mobility.quadrupole_motion(&quadrupoles);
        motion.add(1.0, &squirming.own_motion(&particles.radii));
        motion.add(1.0, acting.ambient);
        Some(motion)
    }
}
