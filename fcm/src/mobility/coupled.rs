//! Solve of the far field together with near pairs, where the far field is evaluated.

use crate::conjugate_gradients::{IterationOutcome, Limits};
use crate::mobility::loads::Motion;
use crate::mobility::past_solutions::PastSolutions;
use crate::mobility::stepping::HeldSteps;
use domain::{ColumnValues, Comm, Particles, RemoteHolder, RemoteList, Units};
use gpu::{GUESSED, NearInput, NearTables};
use solver::BackgroundFlow;
use std::rc::Rc;

/// A far field that finds near pairs, assembles their resistance, and solves for motions and stresslets of rigid
/// spheres together with it.
pub trait CoupledFarField {
    /// Finds the near pairs of the arranged particles and assembles their resistance, by tables that are made once.
    /// All numbers are in the units of the far field, except for a force. Returns the numbers of stiff and of soft
    /// pairs, each counted for both of its particles. Particles that move there may have springs.
    fn assemble(&mut self, tables: &dyn Fn() -> NearTables, input: &NearInput, springs: &HeldSprings) -> [usize; 2];

    /// Load of each particle on the fluid by these pairs at rest in the background, and its first moment: six and five
    /// numbers.
    fn in_flow(&mut self) -> Vec<[f64; 11]>;

    /// Random forces and torques, six numbers a particle, whose covariance is the resistance of the near pairs of the
    /// arranged particles, whose positions are here, by tables that are made once, as in [`Self::assemble`]. The seed
    /// is that of the numbers of pairs, which depend on the ids of the particles and their steps across the faces of
    /// the box.
    fn random_loads(&mut self, tables: &dyn Fn() -> NearTables, particles: &Particles, seed: u64) -> Vec<f64>;

    /// Solves a problem for the arranged particles, which have stresslets, with the near pairs that were assembled
    /// last.
    fn solve(&mut self, problem: &CoupledProblem) -> CoupledSolution;

    /// Residual of a solution with the near pairs that were assembled last, without the background flow.
    fn residual(&mut self, known: &KnownSolution) -> CoupledResidual;

    /// Solution near another one, with the near pairs that were assembled last, without the background flow: with the
    /// system `S` and its right-hand side `r`, the change `dl` of the unknowns `l` of that solution solves
    ///
    /// ```text
    /// S dl = r - S l
    /// ```
    ///
    /// with an error relative to the change.
    fn changed(&mut self, known: &KnownSolution, change: &ChangeLimits) -> ChangedSolution;

    /// The memory that holds the columns of solutions.
    fn holder(&self) -> Rc<dyn RemoteHolder>;

    /// Measures of displacements in that memory.
    fn steps(&self) -> Rc<dyn HeldSteps>;
}

/// Implicit springs of near pairs of particles that move where the far field is evaluated.
#[derive(Clone, Copy, Default)]
pub struct HeldSprings<'a> {
    /// Whether the contacts that [`ContactFarField::loads`] found last have springs.
    ///
    /// [`ContactFarField::loads`]: crate::ContactFarField::loads
    pub are_touching: bool,
    /// Motions for which implicit forces between surfaces are predicted.
    pub predicted: Option<PredictedVelocities<'a>>,
}

/// A background flow in which particles move where the far field is evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingFlow {
    /// The flow.
    pub flow: BackgroundFlow,
    /// The flow that velocities contain while particles move: that one, or none if it advects positions besides.
    pub carried: BackgroundFlow,
}

impl MovingFlow {
    /// A flow that velocities contain while particles move.
    pub fn carrying(flow: BackgroundFlow) -> Self {
        Self { flow, carried: flow }
    }
}

/// Predicted velocities of particles that move where the far field is evaluated.
#[derive(Clone, Copy)]
pub struct PredictedVelocities<'a> {
    /// Velocities with those of a flow, in the order of ids and in the original units.
    pub velocities: &'a RemoteList,
    /// The flow that they contain, in these units.
    pub carried: &'a BackgroundFlow,
    /// Time over which they are predicted.
    pub time: f64,
    /// Units of the laws of forces and of the resistances.
    pub units: Units,
}

/// Relative errors, in the norms of the resistances of single spheres.
#[derive(Debug, Clone, Copy)]
pub struct CoupledTolerances {
    /// Of the near field at the start.
    pub start: f64,
    /// Of the preconditioner in the iteration.
    pub preconditioner: f64,
    /// Of the near field at the end.
    pub end: f64,
}

/// A solution for the arranged particles, or for other positions of them, in scaled units as those of a
/// [`CoupledProblem`].
#[derive(Debug, Clone, Copy)]
pub struct KnownSolution<'a> {
    /// Units of length and viscosity of all numbers; the unit of force is 1.
    pub units: Units,
    /// Known loads, six numbers a particle.
    pub loads: &'a [f64],
    /// Ambient motions, see [`CoupledProblem::ambient`]; empty if there are none.
    pub ambient: &'a [f64],
    /// Velocities and angular velocities, six numbers a particle.
    pub motions: &'a [f64],
    /// First moments `D` in the far field, five numbers a particle.
    pub moments: &'a [f64],
}

/// Residual of a solution in the units of that solution: the motions in which the fluid would have to move besides for
/// it to be exact.
pub struct CoupledResidual {
    /// Velocities and angular velocities, six numbers a particle.
    pub motions: Vec<f64>,
    /// Rates of strain, five numbers a particle.
    pub strain_rates: Vec<f64>,
    /// First moments of near pairs by the motions of the solution, five numbers a particle.
    pub moments_of_pairs: Vec<f64>,
}

/// Limits of the iteration for a change.
#[derive(Clone, Copy)]
pub struct ChangeLimits<'a> {
    /// Ranks, of which there is one.
    pub comm: &'a Comm,
    /// Limits of the iteration, with an error relative to the change.
    pub limits: Limits<'a>,
    /// Relative error of the preconditioner in the iteration.
    pub preconditioner: f64,
}

/// Solution after a change, in the units of the one before.
pub struct ChangedSolution {
    /// Velocities and angular velocities, six numbers a particle.
    pub motions: Vec<f64>,
    /// First moments `D` in the far field, five numbers a particle.
    pub moments: Vec<f64>,
    /// First moments of near pairs by the motions, five numbers a particle.
    pub moments_of_pairs: Vec<f64>,
    /// Result of the iteration.
    pub outcome: IterationOutcome,
}

/// Given forces and torques of a problem, six numbers a particle.
#[derive(Clone, Copy)]
pub enum GivenLoads<'a> {
    /// Numbers; empty if there are no loads.
    Here(&'a [f64]),
    /// Numbers where the far field is evaluated.
    Held(&'a HeldLoads),
}

/// Ambient motions of a problem.
pub enum GivenAmbient<'a> {
    /// Velocities and angular velocities of all particles, six numbers each, then their rates of strain, five each;
    /// empty if there are none.
    Here(Vec<f64>),
    /// Motions where the far field is evaluated, in the original units: [`crate::HeldMotions::ambient`]. At the start
    /// of the solve they are those that other spheres induce, in place of past solutions.
    Held(&'a RemoteList),
}

/// Forces and torques in the memory where the far field is evaluated.
pub struct HeldLoads {
    /// The numbers, if there are any.
    list: Option<RemoteList>,
    /// Largest magnitude of a number, or an estimate.
    largest: f64,
}

impl HeldLoads {
    /// Loads in a list, if there are any, with the magnitude of the largest.
    pub(crate) fn of(list: Option<RemoteList>, largest: f64) -> Self {
        Self { list, largest }
    }

    /// Magnitude of the largest number.
    pub(crate) fn largest(&self) -> f64 {
        self.largest
    }

    /// Copies loads to a memory, six numbers a particle in the order of ids; empty if there are none.
    pub fn new(loads: &[f64], holder: &dyn RemoteHolder) -> Self {
        Self { list: (!loads.is_empty()).then(|| holder.hold(loads)), largest: largest(loads) }
    }

    /// The numbers, if there are any: six a particle, in the order of ids.
    pub fn list(&self) -> Option<&RemoteList> {
        self.list.as_ref()
    }
}

impl GivenLoads<'_> {
    /// Largest magnitude of a number.
    pub(crate) fn largest(&self) -> f64 {
        match self {
            Self::Here(loads) => largest(loads),
            Self::Held(held) => held.largest(),
        }
    }
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |largest, number| largest.max(number.abs()))
}

/// The system of near pairs and far field
///
/// ```text
/// [ I + B^T M_UF B   B^T M_UD ] [g]   [ -B^T (M_UF F + U_a)       ]
/// [ M_EF B           M_ED     ] [D] = [ -E_inf - E_a - M_EF F     ]
/// ```
///
/// with the mobility `M`, the resistance `R = B B^T` of near pairs, known loads `F` and ambient motions `U_a`, `E_a`.
pub struct CoupledProblem<'a> {
    /// Units of length and viscosity of all numbers; the unit of force is 1.
    pub units: Units,
    /// Loads besides those of near pairs that the far field has found in the background.
    pub loads: GivenLoads<'a>,
    /// First moments of other near pairs in the background, five numbers a particle; empty if there are none.
    pub moments: &'a [f64],
    /// Ambient motions.
    pub ambient: GivenAmbient<'a>,
    /// Rate of strain of the background: xx, xy, xz, yy and yz.
    pub background: [f64; 5],
    /// Solutions from which the iteration starts, in the original units.
    pub past: &'a PastSolutions,
    /// The background flow in the original units, if the particles move where the far field is evaluated: then their
    /// motions stay there.
    pub moving_in: Option<MovingFlow>,
    /// Ranks, of which there is one.
    pub comm: &'a Comm,
    /// Limits of the iteration.
    pub limits: Limits<'a>,
    /// Errors of the near field.
    pub tolerances: CoupledTolerances,
}

/// Solution of such a problem, in the original units.
pub struct CoupledSolution {
    /// Velocities and angular velocities relative to the background; empty if the particles move where the far field is
    /// evaluated.
    pub motion: Motion,
    /// Whether all velocities are finite.
    pub is_finite: bool,
    /// All columns of the solution, which stay where the far field is evaluated until they are fetched.
    pub columns: SolutionColumns,
    /// Comparison with the guess for each column of [`PastSolutions`]: with its numbers `x`, and those of the line `l`
    /// and the parabola `p`, the sums of `(x - l) (p - l)` and of `(p - l)^2`, 0 for a column without values. `None`
    /// without past solutions.
    pub compared: Option<[[f64; 2]; GUESSED]>,
    /// Result of the iteration.
    pub outcome: IterationOutcome,
}

/// Columns of a solution in the original units.
#[derive(Debug, Clone, PartialEq)]
pub struct SolutionColumns {
    /// Columns from which later solves start, in the order of [`PastSolutions::columns`].
    pub guessed: [ColumnValues; GUESSED],
    /// Forces on the far field.
    pub forces: ColumnValues,
    /// Torques on the far field.
    pub torques: ColumnValues,
    /// Total stresslets.
    pub stresslets: ColumnValues,
    /// Rates of strain besides that of the background.
    pub strain_rates: ColumnValues,
    /// Velocities with those of [`MovingFlow::carried`] and angular velocities with those of the background, of
    /// particles that move where the far field is evaluated.
    pub moving: Option<[ColumnValues; 2]>,
}
