//! Coupled solve with near pairs or rigid bodies.

use crate::ambient::StrainRate;
use crate::bodies::RigidBodies;
use crate::body_projection::BodyProjection;
use crate::coupled_solver::{END, MOST_ITERATIONS, ROUGH, START};
use crate::pairs::search::{NearPairs, Pairs};
use crate::pairs::squeezed::{PRESSED, SQUEEZED};
use crate::preconditioner::Preconditioner;
use crate::six_vector::{SixVector, SixVectors};
use crate::solution::{Guess, HeldFluctuations, Solution};
use crate::system::{CoupledSystem, FinalIterate, SingleSpheres, SystemSolution, SystemStart, single};
use crate::units::{self, Scaled};
use crate::unknowns::Unknowns;
use domain::parallel::{FusedLoops, all_rows};
use domain::{Comm, Interrupt, Interrupted, Particles, RemoteHolder, Traceless, Units, Vector};
use fcm::{
    HeldLoads, Iterate, IterationOutcome, Limits, Linear, Loads, Motion, MovingFlow, Multipoles, Plan, SolveError,
    conjugate_gradients,
};

/// [`crate::CoupledSolver::solve`] with near pairs or rigid bodies, in scaled units.
pub(super) struct LubricatedSolve<'a> {
    pub(super) comm: &'a Comm,
    pub(super) interrupt: &'a Interrupt,
    pub(super) near: &'a NearPairs,
    /// The memory that holds columns of past solutions, if there is one.
    pub(super) holder: Option<&'a dyn RemoteHolder>,
    pub(super) bodies: Option<&'a RigidBodies>,
    pub(super) is_preconditioned: bool,
    /// Degenerate quadrupoles of squirmers, in the units of the mobility.
    pub(super) quadrupoles: Option<&'a [Vector]>,
    pub(super) particles: &'a Particles,
    /// Strain rate of the background flow.
    pub(super) strain_rate: StrainRate,
}

/// Loads on the particles, ambient motions and the guess of a solution, in the original units.
pub(super) struct SolveCase<'a> {
    pub(super) loads: &'a Loads,
    /// Loads in place of these that are where the far field is evaluated.
    pub(super) held: Option<&'a HeldLoads>,
    /// See [`crate::SolveInput::fluctuations`].
    pub(super) fluctuations: Option<&'a HeldFluctuations>,
    pub(super) ambient: &'a Motion,
    pub(super) guess: Guess,
    /// Whether the columns of the solution may stay where the far field is evaluated.
    pub(super) keeps_columns: bool,
    /// See [`crate::SolveInput::moving_in`].
    pub(super) moving_in: Option<MovingFlow>,
}

/// Single-sphere resistances, known loads, ambient motions and a guess, in scaled units.
#[derive(Default)]
pub(super) struct ScaledInput {
    pub(super) spheres: SingleSpheres,
    /// Given loads and those of near pairs in the ambient flow.
    pub(super) known: SixVectors,
    pub(super) ambient: Motion,
    /// Guess of the motions, and of the first moments.
    pub(super) motions: SixVectors,
    pub(super) moments: Vec<Traceless>,
    /// Known loads, and those that move single spheres as the loads of all others do in the guess, for the
    /// preconditioner.
    pub(super) moving: SixVectors,
}

/// Solution of the system, and the end of the iteration.
pub(super) struct Found {
    pub(super) solved: SystemSolution,
    /// First moments of near pairs by the motions.
    pub(super) by_motions: Vec<Traceless>,
    pub(super) outcome: IterationOutcome,
}

impl LubricatedSolve<'_> {
    /// Solves for the motions of the particles. Collective; an error is an error on all ranks.
    pub(super) fn run(&self, mobility: Scaled, given: SolveCase) -> Result<Solution, SolveError> {
        let (units, plan) = (mobility.units, mobility.mobility.plan().clone());
        let limits =
            Limits { tolerance: plan.iteration_tolerance, iterations: MOST_ITERATIONS, interrupt: self.interrupt };
        if self.near.is_on_device() {
            return self.on_device(mobility, given, limits);
        }
        let mut input = self.scaled(given, &plan, &units);
        let found = self.on_host(mobility, &mut input, limits)?;
        let Found { solved, outcome: IterationOutcome { iterations, residual, .. }, .. } = &found;
        if self.comm.any(!all_rows(solved.motions.0.len(), |row| solved.motions.0[row].linear().is_finite())) {
            return Err(SolveError::NotFinite);
        }
        let constraint_loads = units::times(&self.constraint_loads(solved), units.torque());
        let (iterations, residual) = (*iterations, *residual);
        let solution = Solution { constraint_loads, iterations, residual, ..Solution::default() };
        Ok(self.completed(solution, &found, &input, &units))
    }

    /// The solve by the host, which uses up the guess. Collective.
    fn on_host(&self, mobility: Scaled, input: &mut ScaledInput, limits: Limits) -> Result<Found, SolveError> {
        let ScaledInput { spheres, known, ambient, motions, moments, moving } = input;
        let (motions, moments) = (std::mem::take(motions), std::mem::take(moments));
        let mut matrix = self.preconditioner(&spheres.motion);
        let mut x = match &mut matrix {
            None => unknowns(self.near, &motions, moments),
            Some(matrix) => {
                // The motions of all near pairs, from the guess of those that other spheres induce.
                let found = matrix.solve_with_all(motions, &std::mem::take(moving), START * limits.tolerance);
                Unknowns::of(&found.motions, &found.loads, moments)
            }
        };
        let (quadrupoles, strain_rate) = (self.quadrupoles, self.strain_rate.at_zero);
        let start = SystemStart { loads: known, ambient, quadrupoles, strain_rate, unknowns: &x };
        let (mut system, mut residual) = CoupledSystem::new(mobility, self.near, matrix, spheres, start);
        let mut correction = Unknowns::default();
        let iterate = Iterate { x: &mut x, residual: &mut residual, z: &mut correction };
        let outcome = conjugate_gradients(self.comm, &mut system, iterate, limits);
        ended(&outcome, limits)?;
        let last = FinalIterate { x, residual, correction };
        let solved = system.finish(last, END * limits.tolerance, self.comm);
        let by_motions = self.near.moments_by(&solved.motions);
        Ok(Found { solved, by_motions, outcome })
    }

    /// The input in scaled units, which uses up the guess. The loads that move spheres as in the guess are for the
    /// preconditioner alone.
    fn scaled(&self, given: SolveCase, plan: &Plan, units: &Units) -> ScaledInput {
        let SolveCase { loads, ambient, guess, .. } = given;
        let guess = guess.listed(&self.particles.ids, self.holder);
        let (radii, viscosity) = (&self.particles.radii[..], plan.viscosity / units.viscosity);
        let [torque, velocity, rate] = [units.torque(), units.velocity(), units.rate()].map(|unit| 1.0 / unit);
        let in_flow = &self.near.ambient_loads().0[..];
        let count = radii.len();
        let strained = if plan.multipoles == Multipoles::Dipole { count } else { 0 };
        let moved = |row: usize, of: [&[Vector]; 2]| SixVector::of_row(row, of[0], of[1]).times(velocity, rate);
        let induced = [&guess.induced_velocities[..], &guess.induced_angular_velocities];
        let known =
            |row: usize| SixVector::of_row(row, &loads.forces, &loads.torques).times(1.0, torque) + in_flow[row];
        let moving = |row: usize| known(row) + single(viscosity, radii[row]) * moved(row, induced);
        let moment = |row: usize| guess.stresslets_far.get(row).map_or(Traceless::ZERO, |&s| -(s * torque));
        let mut made = ScaledInput::default();
        let mut loops = FusedLoops::default();
        made.spheres.make_in(&mut loops, viscosity, radii);
        loops.of_rows(&mut made.known.0, count, known);
        loops.of_rows(&mut made.motions.0, count, |row| moved(row, [&guess.velocities, &guess.angular_velocities]));
        loops.of_rows(&mut made.moments, strained, moment);
        if self.has_preconditioner() {
            loops.of_rows(&mut made.moving.0, count, moving);
        }
        units::motion_in(&mut loops, &mut made.ambient, ambient, [velocity, rate]);
        loops.run();
        made
    }

    /// The solution of a system with known loads, in the original units.
    fn completed(&self, mut solution: Solution, found: &Found, input: &ScaledInput, units: &Units) -> Solution {
        let Found { solved: SystemSolution { motions, loads, moments, strain_rates }, by_motions, .. } = found;
        let ScaledInput { spheres, known, .. } = input;
        let in_strain = self.near.ambient_moments();
        let (count, [torque, velocity, rate]) = (motions.0.len(), [units.torque(), units.velocity(), units.rate()]);
        let load = |row: usize| known.0[row] + loads.0[row];
        let induced = |row: usize| motions.0[row] - load(row) / spheres.motion[row];
        let stresslet = |row: usize| -moments[row] + (in_strain[row] - by_motions[row]);
        let Solution { motion, stresslets, far, induced: induced_motion, .. } = &mut solution;
        let mut loops = FusedLoops::default();
        loops.of_rows(&mut motion.velocities, count, |row| motions.0[row].linear() * velocity);
        loops.of_rows(&mut motion.angular_velocities, count, |row| motions.0[row].angular() * rate);
        loops.mapped(&mut motion.strain_rates, strain_rates, |&e| e * rate);
        loops.of_rows(stresslets, moments.len(), |row| stresslet(row) * torque);
        loops.of_rows(&mut far.forces, count, |row| load(row).linear());
        loops.of_rows(&mut far.torques, count, |row| load(row).angular() * torque);
        loops.mapped(&mut far.stresslets, moments, |&d| -d * torque);
        loops.of_rows(&mut induced_motion.velocities, count, |row| induced(row).linear() * velocity);
        loops.of_rows(&mut induced_motion.angular_velocities, count, |row| induced(row).angular() * rate);
        loops.run();
        solution
    }

    /// Whether the solve has a preconditioner; bodies always need it.
    fn has_preconditioner(&self) -> bool {
        self.is_preconditioned || self.bodies.is_some()
    }

    /// The preconditioner for single-sphere resistances, if there is one. Collective.
    fn preconditioner<'b>(&'b self, single: &'b [SixVector]) -> Option<Preconditioner<'b>> {
        if !self.has_preconditioner() {
            return None;
        }
        let projection = |bodies: &'b RigidBodies| {
            BodyProjection::new(bodies, self.near, single, bodies.members().offsets(self.particles, self.strain_rate))
        };
        let matrix = Preconditioner::new(self.comm, self.near, single, ROUGH);
        let Some(bodies) = self.bodies else {
            // Squirmers press on each other, where most passive spheres keep off.
            let least = if self.quadrupoles.is_some() { SQUEEZED } else { PRESSED };
            return Some(matrix.with_squeezed_pairs(least));
        };
        Some(matrix.with_bodies(Some(projection(bodies))))
    }

    /// Loads that keep bodies rigid: those of the solution minus the lubrication of the motions. Collective.
    fn constraint_loads(&self, solved: &SystemSolution) -> Loads {
        let Some(bodies) = self.bodies else { return Loads::default() };
        let mut loads = self.near.times(&[Pairs::Stiff, Pairs::Soft], &solved.motions);
        loads.add(1.0, &solved.loads);
        bodies.members().keep_members(&mut loads);
        Loads { forces: loads.linear(), torques: loads.angular(), stresslets: Vec::new() }
    }
}

/// The error of a solve that failed.
pub(super) fn ended(outcome: &IterationOutcome, limits: Limits) -> Result<(), SolveError> {
    let IterationOutcome { iterations, residual, converged, interrupted } = *outcome;
    if interrupted {
        return Err(Interrupted.into());
    }
    if !residual.is_finite() {
        return Err(SolveError::NotFinite);
    }
    let tolerance = limits.tolerance;
    if converged { Ok(()) } else { Err(SolveError::NotConverged { iterations, residual, tolerance }) }
}

/// Unknowns that correspond to motions of the particles. Collective.
pub(super) fn unknowns(near: &NearPairs, motions: &SixVectors, moments: Vec<Traceless>) -> Unknowns {
    Unknowns::of(motions, &near.times(&[Pairs::Stiff, Pairs::Soft], motions), moments)
}
