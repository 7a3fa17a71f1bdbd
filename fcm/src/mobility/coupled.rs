//! Solve of the far field together with near pairs, where the far field is evaluated.

use crate::conjugate_gradients::{IterationOutcome, Limits};
use domain::{Comm, Particles, Units};
use gpu::{NearInFlow, NearInput, NearTables};

/// A far field that finds near pairs, assembles their resistance, and solves for motions and stresslets of rigid
/// spheres together with it.
pub trait CoupledFarField {
    /// Finds the near pairs of the arranged particles and assembles their resistance, by tables that are made once.
    /// All numbers are in the units of the far field, except for a force.
    fn assemble(&mut self, tables: &dyn Fn() -> NearTables, input: &NearInput) -> NearInFlow;

    /// Random forces and torques, six numbers a particle, whose covariance is the resistance of the near pairs of the
    /// arranged particles, by tables that are made once, as in [`Self::assemble`]. The seed is that of the numbers of
    /// pairs, which depend on the ids of the particles and their steps across the faces of the box.
    fn random_loads(&mut self, tables: &dyn Fn() -> NearTables, particles: &Particles, seed: u64) -> Vec<f64>;

    /// Solves a problem for the arranged particles, which have stresslets, with the near pairs that were assembled
    /// last.
    fn solve(&mut self, problem: &CoupledProblem) -> CoupledSolution;
}

/// Start of the iteration, as numbers of one particle after the other.
pub struct CoupledStart {
    /// Velocities and angular velocities from which the near field is solved.
    pub motions: Vec<f64>,
    /// Forces and torques of that solve.
    pub loads: Vec<f64>,
    /// Minus the stresslets.
    pub moments: Vec<f64>,
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
    /// Forces and torques, six numbers a particle.
    pub loads: &'a [f64],
    /// Ambient velocities and angular velocities of all particles, six numbers each, then their rates of strain, five
    /// each; empty if there are none.
    pub ambient: Vec<f64>,
    /// Rate of strain of the background: xx, xy, xz, yy and yz.
    pub background: [f64; 5],
    /// Start of the iteration.
    pub start: CoupledStart,
    /// Ranks, of which there is one.
    pub comm: &'a Comm,
    /// Limits of the iteration.
    pub limits: Limits<'a>,
    /// Errors of the near field.
    pub tolerances: CoupledTolerances,
}

/// Solution of such a problem, as numbers of one particle after the other.
pub struct CoupledSolution {
    /// Velocities and angular velocities.
    pub motions: Vec<f64>,
    /// Loads of near pairs on the far field.
    pub loads: Vec<f64>,
    /// Minus the stresslets.
    pub moments: Vec<f64>,
    /// Rates of strain besides that of the background.
    pub strain_rates: Vec<f64>,
    /// First moments of lubrication by the motions.
    pub first_moments: Vec<f64>,
    /// Result of the iteration.
    pub outcome: IterationOutcome,
}
