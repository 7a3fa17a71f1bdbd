//! Random motions and loads of particles that move where the far field is evaluated.

use crate::conjugate_gradients::IterationOutcome;
use crate::lanczos::DrawDiagnostics;
use crate::mobility::coupled::{ChangeLimits, HeldLoads};
use crate::mobility::noise::Stream;
use domain::{ColumnValues, Particles, RemoteList, Units};
use gpu::{CloseSpheres, NearTables};
use solver::BackgroundFlow;

/// A far field that moves particles with stresslets, draws their random motions and loads, and keeps both.
pub trait FluctuatingFarField {
    /// Draws random motions of the arranged particles, which move there, with the mobility times the square of an
    /// amplitude as covariance.
    fn draw_motions(&mut self, draw: &HeldDraw) -> (HeldMotions, DrawDiagnostics);

    /// Adds random forces and torques, as of [`CoupledFarField::random_loads`], to steady loads, by tables that are
    /// made once.
    ///
    /// [`CoupledFarField::random_loads`]: crate::CoupledFarField::random_loads
    fn draw_loads(&mut self, tables: &dyn Fn() -> NearTables, loads: &HeldLoads, draw: &LoadDraw) -> HeldLoads;

    /// Ambient motions for which a solution is exact under loads and the forces between surfaces of the near pairs that
    /// were assembled last, without a background flow, see [`CoupledFarField::residual`].
    ///
    /// [`CoupledFarField::residual`]: crate::CoupledFarField::residual
    fn exact_conditions(&mut self, found: &HeldSolution, loads: &HeldLoads) -> ExactConditions;

    /// Change of a solution, over a divisor, to the near pairs that were assembled last, without a background flow, and
    /// to the present positions, under the conditions for which it was exact; see [`CoupledFarField::changed`].
    ///
    /// [`CoupledFarField::changed`]: crate::CoupledFarField::changed
    fn change_over(
        &mut self,
        found: &HeldSolution,
        exact: &ExactConditions,
        divisor: f64,
        limits: &ChangeLimits,
    ) -> SolutionChange;

    /// Pairs of the arranged particles that overlap, or have a gap below a minimum, over the mean radius, if there is
    /// one.
    fn close_spheres(&mut self, minimum_gap: Option<f64>) -> CloseSpheres;
}

/// A draw of random motions of particles that move in a flow.
#[derive(Clone, Copy)]
pub struct HeldDraw<'a> {
    /// The particles.
    pub particles: &'a Particles,
    /// Relative error allowed in square roots that are found by iteration.
    pub tolerance: f64,
    /// Random numbers.
    pub stream: Stream,
    /// Factor of the motions.
    pub amplitude: f64,
    /// The flow that velocities contain while particles move.
    pub carried: &'a BackgroundFlow,
}

/// A draw of random loads of particles that move.
#[derive(Clone, Copy)]
pub struct LoadDraw<'a> {
    /// Ids of the particles.
    pub ids: &'a [u64],
    /// Seed of the numbers of pairs.
    pub seed: u64,
    /// Factor of the loads, in the original units.
    pub amplitude: f64,
    /// Units of length and viscosity of the loads and of the tables.
    pub units: Units,
}

/// Random motions where the far field is evaluated, in the original units.
pub struct HeldMotions {
    /// Motions of the fluid at each particle: velocity, angular velocity and rate of strain, eleven numbers.
    pub ambient: ColumnValues,
    /// These velocities with those of that flow, three numbers.
    pub velocities: ColumnValues,
}

/// A solution where the far field is evaluated: columns in the order of ids and in the original units.
#[derive(Debug, Clone)]
pub struct HeldSolution {
    /// Units of length and viscosity in which solutions are found; the unit of force is 1.
    pub units: Units,
    /// Velocities and angular velocities relative to the background.
    pub motions: [RemoteList; 2],
    /// Stresslets of the far field.
    pub far_stresslets: RemoteList,
}

/// Loads and ambient motions for which a solution is exact, and its total stresslets; columns as those of the solution.
#[derive(Debug, Clone)]
pub struct ExactConditions {
    /// Forces and torques.
    pub loads: [RemoteList; 2],
    /// Velocities, angular velocities and rates of strain of the fluid, eleven numbers a particle.
    pub ambient: RemoteList,
    /// Total stresslets.
    pub stresslets: RemoteList,
}

/// Change of a solution over a divisor; columns as those of the solution.
pub struct SolutionChange {
    /// Of velocities.
    pub velocities: RemoteList,
    /// Of total stresslets.
    pub stresslets: RemoteList,
    /// Result of the iteration.
    pub outcome: IterationOutcome,
}
