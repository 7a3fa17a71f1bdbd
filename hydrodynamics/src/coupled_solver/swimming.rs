//! Ambient motions and quadrupoles by the slip of squirmers.

use crate::coupled_solver::CoupledSolver;
use crate::solution::SolveInput;
use domain::{Particles, Vector};
use fcm::Motion;

/// Input of a solve by the slip of squirmers.
pub(super) struct SlipInput {
    /// Motions of the ambient fluid, and of squirmers alone besides those by quadrupoles.
    ambient: Motion,
    /// Degenerate quadrupoles of the rank's particles.
    quadrupoles: Vec<Vector>,
}

impl SlipInput {
    /// The ambient motions and the quadrupoles.
    pub fn parts(&self) -> (&Motion, Option<&[Vector]>) {
        (&self.ambient, Some(&self.quadrupoles))
    }
}

impl CoupledSolver {
    /// Ambient motions of an input with those by the slip of its squirmers, and their degenerate quadrupoles. `None`
    /// without squirmers. Collective.
    ///
    /// # Panics
    /// If [`crate::Squirming::check`] refuses the plan.
    pub(super) fn swimming(&mut self, particles: &Particles, acting: &SolveInput) -> Option<SlipInput> {
        let squirming = acting.squirming?;
        if !self.partition.comm().any(!squirming.is_empty()) {
            return None;
        }
        let mut ambient = squirming.own_motion(&particles.radii);
        ambient.add(1.0, acting.ambient);
        let viscosity = self.far.mobility().plan().viscosity;
        Some(SlipInput { ambient, quadrupoles: squirming.quadrupoles(viscosity, &particles.radii) })
    }
}
