//! Solve with near pairs or rigid bodies.

use crate::ambient::StrainRate;
use crate::bodies::RigidBodies;
use crate::body_projection::BodyProjection;
use crate::coupled_solver::{END, MOST_ITERATIONS, ROUGH, START, induced};
use crate::pairs::search::{NearPairs, Pairs};
use crate::preconditioner::Preconditioner;
use crate::six_vector::{SixVector, SixVectors};
use crate::solution::{Guess, Solution};
use crate::system::{self, CoupledSystem, FinalIterate, SingleSpheres, SystemStart, Unknowns};
use crate::units::Scaled;
use domain::parallel::{all_rows, change, mapped};
use domain::{Comm, Interrupt, Interrupted, Particles, Traceless, Vector};
use fcm::{Iterate, IterationOutcome, Limits, Linear, Loads, Motion, Multipoles, SolveError, conjugate_gradients};

/// [`CoupledSolver::solve`] with near pairs or rigid bodies, in scaled units.
pub(super) struct LubricatedSolve<'a> {
    pub comm: &'a Comm,
    pub interrupt: &'a Interrupt,
    pub near: &'a NearPairs,
    pub bodies: Option<&'a RigidBodies>,
    pub is_preconditioned: bool,
    /// Degenerate quadrupoles of squirmers, in the units of the mobility.
    pub quadrupoles: Option<&'a [Vector]>,
    pub particles: &'a Particles,
    /// Strain rate of the background flow.
    pub strain_rate: StrainRate,
}

/// Input of a solve for free spheres and bodies, in scaled units.
#[derive(Clone, Copy)]
pub(super) struct GivenSolve<'a> {
    /// Known loads, with those of near pairs in the ambient flow.
    pub loads: &'a SixVectors,
    pub ambient: &'a Motion,
    pub guess: &'a Guess,
    pub spheres: &'a SingleSpheres,
    pub limits: Limits<'a>,
}

/// Solution without what follows from it.
pub(super) struct Found {
    pub motion: Motion,
    /// Loads of near pairs on the far field, with those by which bodies are rigid.
    pub loads: SixVectors,
    /// Minus the stresslets of the far field.
    pub moments: Vec<Traceless>,
    pub outcome: IterationOutcome,
}

impl GivenSolve<'_> {
    /// Loads under which near pairs alone move at the start as other spheres are guessed to move them.
    pub fn start_loads(&self) -> SixVectors {
        let Guess { induced_velocities, induced_angular_velocities, .. } = self.guess;
        let mut loads = self.loads.clone();
        let induced = SixVectors::new(loads.0.len(), induced_velocities, induced_angular_velocities);
        loads.add_resisted(1.0, &self.spheres.motion, &induced);
        loads
    }
}

impl LubricatedSolve<'_> {
    pub(super) fn run(
        &self,
        mut mobility: Scaled,
        loads: &Loads,
        ambient: &Motion,
        guess: &Guess,
    ) -> Result<Solution, SolveError> {
        let (near, radii) = (self.near, &self.particles.radii[..]);
        let plan = mobility.mobility.plan();
        let viscosity = plan.viscosity / mobility.units.viscosity;
        let limits =
            Limits { tolerance: plan.iteration_tolerance, iterations: MOST_ITERATIONS, interrupt: self.interrupt };
        let spheres = SingleSpheres::new(viscosity, radii);
        let mut known = SixVectors::new(radii.len(), &loads.forces, &loads.torques);
        known.add(1.0, near.ambient_loads());
        let given = GivenSolve { loads: &known, ambient, guess, spheres: &spheres, limits };
        let found = match self.on_device(&mut mobility, &given) {
            Some(found) => found?,
            None => self.on_host(mobility, &given)?,
        };
        let Found { motion, loads: by_pairs, moments, outcome } = found;
        if self.comm.any(!all_rows(radii.len(), |row| motion.velocities[row].is_finite())) {
            return Err(SolveError::NotFinite);
        }
        let motions = SixVectors::new(radii.len(), &motion.velocities, &motion.angular_velocities);
        let constraint_loads = self.constraint_loads(&by_pairs, &motions);
        known.add(1.0, &by_pairs);
        let far = system::far_loads(&known, &moments);
        let mut stresslets = near.stresslets(&motions);
        stresslets.truncate(far.stresslets.len());
        change(&mut stresslets, &far.stresslets, |near, &far| *near = far + *near);
        let induced = induced(&spheres.motion, &motion, &far);
        let (curvature, IterationOutcome { iterations, residual, .. }) = (0.0, outcome);
        Ok(Solution { motion, stresslets, far, constraint_loads, induced, curvature, iterations, residual })
    }

    /// The solve by the host. Collective.
    fn on_host(&self, mobility: Scaled, given: &GivenSolve) -> Result<Found, SolveError> {
        let &GivenSolve { loads, ambient, guess, spheres, limits } = given;
        let (comm, near, count) = (self.comm, self.near, loads.0.len());
        let is_rigid = mobility.mobility.plan().multipoles == Multipoles::Dipole;
        let motions = SixVectors::new(count, &guess.velocities, &guess.angular_velocities);
        let moments = moments(guess, if is_rigid { count } else { 0 });
        let mut matrix = self.preconditioner(&spheres.motion);
        let mut x = match &mut matrix {
            None => unknowns(near, &motions, moments),
            Some(matrix) => {
                let [motions, resisted] =
                    matrix.solve_with_all(motions, &given.start_loads(), START * limits.tolerance);
                Unknowns::of(&motions, &resisted, moments)
            }
        };
        let mut system = CoupledSystem::new(
            mobility,
            near,
            matrix,
            spheres,
            SystemStart { loads, ambient, quadrupoles: self.quadrupoles, unknowns: &x },
        );
        let mut residual = system.residual(&x, self.strain_rate.at_zero);
        let mut correction = Unknowns::default();
        let iterate = Iterate { x: &mut x, residual: &mut residual, z: &mut correction };
        let outcome = conjugate_gradients(comm, &mut system, iterate, limits);
        ended(&outcome, limits)?;
        let last = FinalIterate { x, residual: &residual, correction };
        let (motion, x) = system.finish(last, END * limits.tolerance, comm);
        Ok(Found { motion, loads: x.loads(), moments: x.moments, outcome })
    }

    /// The preconditioner for single-sphere resistances; bodies always need it. Collective.
    fn preconditioner<'b>(&'b self, single: &'b [SixVector]) -> Option<Preconditioner<'b>> {
        if !self.is_preconditioned && self.bodies.is_none() {
            return None;
        }
        let projection = |bodies: &'b RigidBodies| {
            BodyProjection::new(bodies, self.near, single, bodies.members().offsets(self.particles, self.strain_rate))
        };
        let matrix = Preconditioner::new(self.comm, self.near, single, ROUGH);
        Some(matrix.with_bodies(self.bodies.map(projection)))
    }

    /// Loads that keep bodies rigid: those of the solution minus the lubrication of the motions. Collective.
    fn constraint_loads(&self, by_pairs: &SixVectors, motions: &SixVectors) -> Loads {
        let Some(bodies) = self.bodies else { return Loads::default() };
        let mut loads = by_pairs.clone();
        loads.add(1.0, &self.near.times(&[Pairs::Stiff, Pairs::Soft], motions));
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

/// First moments of a guess for `count` spheres.
pub(super) fn moments(guess: &Guess, count: usize) -> Vec<Traceless> {
    let mut moments = mapped(&guess.stresslets_far, |&s| -s);
    moments.resize(count, Traceless::ZERO);
    moments
}

/// Unknowns that correspond to motions of the particles. Collective.
pub(super) fn unknowns(near: &NearPairs, motions: &SixVectors, moments: Vec<Traceless>) -> Unknowns {
    Unknowns::of(motions, &near.times(&[Pairs::Stiff, Pairs::Soft], motions), moments)
}
