//! Forces between the surfaces of spheres, added where the far field is evaluated.

use crate::coupled_solver::CoupledSolver;
use crate::pairs::surface_laws::{self, TakenForce};
use crate::solution::SolveInput;
use domain::parallel::{change, copied};
use domain::{Particles, PeriodicBox};
use fcm::Loads;

impl CoupledSolver {
    /// Takes over forces between the surfaces of spheres, if the back end of the far field adds them up: they act in
    /// solves with [`SolveInput::surface_forces`]. Returns whether it does. Solves of particles that move there may
    /// predict implicit ones, see [`HeldForces::prediction`](crate::HeldForces::prediction).
    pub fn take_surface_forces(&mut self, forces: &[TakenForce]) -> bool {
        let can_add = self.far.mobility().surface().is_some();
        let radii = &self.far.mobility().plan().radii;
        self.surface_laws = can_add.then(|| surface_laws::laws(forces, radii, self.units.length));
        can_add
    }

    /// The loads of a solve with the forces between surfaces, unless there are none to add.
    pub(super) fn with_surface_forces(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        input: &SolveInput,
    ) -> Option<Loads> {
        let laws = self.surface_laws.as_ref().filter(|_| input.surface_forces)?;
        let mobility = self.far.mobility();
        mobility.follow(cell, particles);
        let mut forces = mobility.surface()?.forces(laws);
        change(&mut forces, &input.loads.forces, |sum, &force| *sum += force);
        let torques = copied(&input.loads.torques);
        Some(Loads { forces, torques, stresslets: Vec::new() })
    }
}
