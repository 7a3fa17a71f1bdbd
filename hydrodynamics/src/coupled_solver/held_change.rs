//! Conditions for which random solutions are exact, and their change under a small displacement, of particles that move
//! where the far field is evaluated.

use crate::ambient::StrainRate;
use crate::coupled_solver::lubricated_solve::ended;
use crate::coupled_solver::on_device::SHARP;
use crate::coupled_solver::{CoupledSolver, MOST_ITERATIONS};
use crate::solution::SolveInput;
use domain::{Particles, PeriodicBox, RemoteList};
use fcm::{
    ChangeLimits, ExactConditions, HeldLoads, HeldSolution, Limits, Loads, MovingFlow, SolutionChange, SolveError,
};
use solver::BackgroundFlow;

/// Message of a panic, which would be a mistake in the program.
const ELSEWHERE: &str = "the far field moves these particles";

impl CoupledSolver {
    /// The loads and ambient motions for which a solution under held loads is exact, as of
    /// [`Self::equivalent_ambient`]; the loads are these and the forces between surfaces that the solver [has
    /// taken](Self::take_surface_forces).
    ///
    /// # Panics
    ///
    /// Unless these particles have moved where the far field is evaluated.
    pub(crate) fn exact_conditions(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        found: &HeldSolution,
        loads: &HeldLoads,
    ) -> ExactConditions {
        self.assemble_held(cell, particles, true);
        self.far.mobility().fluctuating().expect(ELSEWHERE).exact_conditions(found, loads)
    }

    /// The change of such a solution at the present positions over a divisor, as of [`Self::perturbed_solution`].
    ///
    /// # Panics
    ///
    /// Unless these particles have moved where the far field is evaluated.
    pub(crate) fn held_change(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        found: &HeldSolution,
        exact: &ExactConditions,
        [divisor, tolerance]: [f64; 2],
    ) -> Result<[RemoteList; 2], SolveError> {
        self.assemble_held(cell, particles, false);
        let interrupt = self.far.interrupt().clone();
        let limits = Limits { tolerance, iterations: MOST_ITERATIONS, interrupt: &interrupt };
        let change = ChangeLimits { comm: self.partition.comm(), limits, preconditioner: SHARP };
        let far = self.far.mobility().fluctuating().expect(ELSEWHERE);
        let SolutionChange { velocities, stresslets, outcome } = far.change_over(found, exact, divisor, &change);
        ended(&outcome, limits)?;
        Ok([velocities, stresslets])
    }

    /// A solution in lists, in the units of solves.
    pub(crate) fn held_solution(&self, motions: [RemoteList; 2], far_stresslets: RemoteList) -> HeldSolution {
        HeldSolution { units: self.units, motions, far_stresslets }
    }

    /// Finds the near pairs of particles at rest that move where the far field is evaluated, with or without the forces
    /// between surfaces.
    fn assemble_held(&mut self, cell: &PeriodicBox, particles: &Particles, surface_forces: bool) {
        let none = Loads::default();
        let at_rest = SolveInput::new(&none, StrainRate::default());
        let at_rest =
            SolveInput { surface_forces, moving_in: Some(MovingFlow::carrying(BackgroundFlow::NONE)), ..at_rest };
        self.far.mobility().constrain(None);
        self.pairs_of_solve(cell, [particles; 2], &at_rest);
    }
}
