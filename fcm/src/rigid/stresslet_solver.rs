//! Rigid spheres: the stresslets that leave no rate of strain within them.

use crate::conjugate_gradients::{Iterate, Limits, System, conjugate_gradients};
use crate::mobility::loads::{Loads, Motion, Output};
use crate::mobility::work::Work;
use crate::mobility::{Mobility, RigidProblem, RigidSolution};
use crate::plan::Plan;
use crate::plan::problem::Multipoles;
use domain::parallel::{all_rows, change_rows, copied, mapped, of_rows};
use domain::{Comm, Interrupt, Interrupted, Particles, Partition, PeriodicBox, Traceless, Vector, sphere};

/// Failure of a solve, the same on all ranks.
#[derive(Debug, Clone, thiserror::Error, PartialEq)]
pub enum SolveError {
    /// The stresslets did not converge.
    #[error(
        "the stresslets did not converge: after {iterations} iterations the residual is {residual:.1e}, asked for \
         {tolerance:.1e}; allow a larger hydrodynamics.iteration_tolerance, or look for overlapping particles"
    )]
    NotConverged {
        /// Iterations done.
        iterations: usize,
        /// Residual reached.
        residual: f64,
        /// Residual asked for.
        tolerance: f64,
    },
    /// Positions or loads are not finite.
    #[error(
        "the motion of the particles is not finite; look for forces beyond the range of numbers (species.force, \
         repulsion.strength, ...), or for particles at one point"
    )]
    NotFinite,
    /// Some rank was asked to stop.
    #[error("the solve was interrupted")]
    Interrupted(#[from] Interrupted),
}

/// Motions of rigid spheres and the outcome of the solve for them.
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    /// Velocities, angular velocities and rates of strain relative to the background flow; with monopoles only, only
    /// velocities.
    pub motion: Motion,
    /// Stresslets of the particles; empty with monopoles only.
    pub stresslets: Vec<Traceless>,
    /// Applications of the mobility in the iteration for the stresslets.
    pub iterations: usize,
    /// Relative error left in the stresslets, as the iteration estimates it.
    pub residual: f64,
}

/// Input of a solve for rigid spheres.
#[derive(Debug, Clone, Copy)]
pub struct RigidInput<'a> {
    /// Loads; with dipoles, their stresslets are ignored and solved for.
    pub loads: &'a Loads,
    /// Additional ambient motions of the fluid, one per particle, or none.
    pub ambient: &'a Motion,
    /// Rate of strain of the background flow.
    pub background: Traceless,
    /// Stresslets that the iteration starts from, one per particle, or none.
    pub guess: &'a [Traceless],
    /// Degenerate quadrupoles, one per particle, on all ranks or on none; only with dipoles.
    pub quadrupoles: Option<&'a [Vector]>,
}

/// Solver for rigid spheres: forces and torques to motions, with the stresslets that keep the spheres rigid.
///
/// With `M` the mobility `(F, T, -S) -> (V, Omega, E)`, the stresslets solve `M_EE (-S) = -(E_inf + E_FT)`, where
/// `E_FT` is the rate of strain by forces and torques and `E_inf` the background's: a symmetric positive definite
/// system.
pub struct StressletSolver {
    mobility: Mobility,
    comm: Comm,
    interrupt: Interrupt,
}

/// Largest number of iterations for the stresslets.
const MOST_ITERATIONS: usize = 500;

impl StressletSolver {
    /// Sets up the solver of a plan, on ranks that share the grid by `partition`.
    pub fn new(plan: &Plan, partition: &Partition) -> Self {
        Self::of(Mobility::new(plan, partition), partition.comm())
    }

    /// The solver of a mobility.
    pub fn of(mobility: Mobility, comm: &Comm) -> Self {
        Self { mobility, comm: comm.clone(), interrupt: Interrupt::NEVER }
    }

    /// Polls this interrupt at each evaluation of a solve from now on.
    pub fn listen(&mut self, interrupt: Interrupt) {
        self.interrupt = interrupt;
    }

    /// The interrupt that is polled.
    pub fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// The mobility, for its fields and its record of work.
    pub fn mobility(&mut self) -> &mut Mobility {
        &mut self.mobility
    }

    /// Work done so far.
    pub fn work(&self) -> Work {
        self.mobility.work()
    }

    /// Motion of the particles under `loads`, relative to a background flow whose rate of strain is `background`.
    /// With dipoles, `loads.stresslets` are ignored and solved for, starting from `guess` (one per particle, or
    /// none). Collective; an error is an error on all ranks.
    pub fn solve(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        loads: &Loads,
        background: Traceless,
        guess: &[Traceless],
    ) -> Result<Solved, SolveError> {
        let (ambient, quadrupoles) = (&Motion::default(), None);
        self.solve_in(cell, particles, &RigidInput { loads, ambient, background, guess, quadrupoles })
    }

    /// The same with additional ambient motions of the fluid and degenerate quadrupoles.
    pub fn solve_in(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        input: &RigidInput,
    ) -> Result<Solved, SolveError> {
        self.mobility.follow(cell, particles);
        let solved = match self.mobility.plan().multipoles {
            Multipoles::Monopole | Multipoles::Moments => self.free(input.loads, input.ambient),
            Multipoles::Dipole => self.rigid(&particles.radii, input)?,
        };
        let finite = all_rows(particles.len(), |row| solved.motion.velocities[row].is_finite());
        if self.comm.any(!finite) { Err(SolveError::NotFinite) } else { Ok(solved) }
    }

    fn free(&mut self, loads: &Loads, ambient: &Motion) -> Solved {
        let forces = Loads { forces: loads.forces.clone(), ..Loads::default() };
        let mut motion = self.mobility.apply(&forces, Output::Velocities);
        motion.add(1.0, ambient);
        Solved { motion, stresslets: Vec::new(), iterations: 0, residual: 0.0 }
    }

    fn rigid(&mut self, radii: &[f64], input: &RigidInput) -> Result<Solved, SolveError> {
        if input.quadrupoles.is_none()
            && let Some(solved) = self.resident(radii.len(), input)
        {
            return solved;
        }
        let &RigidInput { loads, ambient, background, guess, quadrupoles } = input;
        let (mut motion, mut resistances) = {
            let start = Loads { stresslets: guess.to_vec(), ..loads.clone() };
            let motion = match quadrupoles {
                Some(quadrupoles) => self.mobility.apply_with_quadrupoles(&start, quadrupoles),
                None => self.mobility.apply(&start, Output::All),
            };
            (motion, start.stresslets)
        };
        motion.add(1.0, ambient);
        // The unknowns are D = -S, for which the system is positive definite.
        resistances.resize(radii.len(), Traceless::ZERO);
        change_rows(&mut resistances, |_, s| *s = -*s);
        let mut residual = mapped(&motion.strain_rates, |&e| -(e + background));
        let viscosity = self.mobility.plan().viscosity;
        let diagonal = mapped(radii, |a| sphere::strain_resistance(viscosity, *a));
        let tolerance = self.mobility.plan().iteration_tolerance;
        let limits = Limits { tolerance, iterations: MOST_ITERATIONS, interrupt: &self.interrupt };
        let mut z = Vec::new();
        let mut strain = Strain { mobility: &mut self.mobility, diagonal, motion, step: Motion::default() };
        let iterate = Iterate { x: &mut resistances, residual: &mut residual, z: &mut z };
        let outcome = conjugate_gradients(&self.comm, &mut strain, iterate, limits);
        let motion = strain.motion;
        let stresslets = mapped(&resistances, |&d| -d);
        ended(RigidSolution { motion, stresslets, outcome }, tolerance)
    }

    /// The same where the far field is evaluated, if it solves there.
    fn resident(&mut self, count: usize, input: &RigidInput) -> Option<Result<Solved, SolveError>> {
        let tolerance = self.mobility.plan().iteration_tolerance;
        let far = self.mobility.rigid()?;
        let mut loads = Loads { stresslets: input.guess.to_vec(), ..input.loads.clone() };
        loads.stresslets.resize(count, Traceless::ZERO);
        let ambient = |row: usize| input.ambient.strain_rates.get(row).copied().unwrap_or(Traceless::ZERO);
        let strain_rates: Vec<_> = (0..count).map(|row| ambient(row) + input.background).collect();
        let limits = Limits { tolerance, iterations: MOST_ITERATIONS, interrupt: &self.interrupt };
        let problem = RigidProblem { loads: &loads, strain_rates: &strain_rates, comm: &self.comm, limits };
        let mut solution = far.solve(&problem);
        solution.motion.add(1.0, input.ambient);
        Some(ended(solution, tolerance))
    }
}

/// The solution, if the iteration has converged.
fn ended(solution: RigidSolution, tolerance: f64) -> Result<Solved, SolveError> {
    let RigidSolution { motion, stresslets, outcome } = solution;
    if outcome.interrupted {
        return Err(Interrupted.into());
    }
    if !outcome.residual.is_finite() {
        return Err(SolveError::NotFinite);
    }
    let (iterations, residual) = (outcome.iterations, outcome.residual);
    if !outcome.converged {
        return Err(SolveError::NotConverged { iterations, residual, tolerance });
    }
    Ok(Solved { motion, stresslets, iterations, residual })
}

/// System for the stresslets: rate of strain by the stresslets `-D`. The whole motion follows the iteration.
struct Strain<'a> {
    mobility: &'a mut Mobility,
    /// Resistance of single spheres to strain.
    diagonal: Vec<f64>,
    motion: Motion,
    step: Motion,
}

impl System for Strain<'_> {
    type Unknowns = Vec<Traceless>;
    type Residual = Vec<Traceless>;

    fn product(&self, residual: &Vec<Traceless>, x: &Vec<Traceless>) -> f64 {
        residual.iter().zip(x).map(|(&r, &x)| r.contract(x)).sum()
    }

    fn apply(&mut self, direction: &Vec<Traceless>) -> Vec<Traceless> {
        let stresslets = mapped(direction, |&d| -d);
        let loads = Loads { stresslets, ..Loads::default() };
        // Releases the memory of the last step before this one's is allocated.
        self.step = Motion::default();
        self.step = self.mobility.apply(&loads, Output::All);
        copied(&self.step.strain_rates)
    }

    fn on_step(&mut self, length: f64) {
        self.motion.add(length, &self.step);
    }

    fn precondition(&mut self, residual: &Vec<Traceless>) -> Vec<Traceless> {
        of_rows(residual.len(), |row| residual[row] * self.diagonal[row])
    }

    fn size(&self, x: &Vec<Traceless>) -> f64 {
        x.iter().zip(&self.diagonal).map(|(&x, &d)| x.contract(x) / d).sum()
    }
}
