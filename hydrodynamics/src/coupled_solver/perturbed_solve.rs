//! Change of a solution under a small displacement of the spheres, for finite-difference drift.

use crate::ambient::StrainRate;
use crate::coupled_solver::lubricated_solve::{ended, unknowns};
use crate::coupled_solver::{CoupledSolver, MOST_ITERATIONS, ROUGH};
use crate::pairs::search::{Connections, NearPairs};
use crate::preconditioner::Preconditioner;
use crate::six_vector::{SixVector, SixVectors};
use crate::solution::{NO_AMBIENT, Solution, StoredSolution};
use crate::system::{CoupledSystem, FinalIterate, SingleSpheres, SystemStart};
use crate::units::{self, Scaled};
use crate::unknowns::{Residual, Unknowns};
use domain::{DomainView, Interrupt, Particles, PeriodicBox, Traceless, Units};
use fcm::{Iterate, Limits, Loads, Motion, SolveError, conjugate_gradients};

/// The system at given positions, and the residual of a solution there.
struct ResidualSystem<'a> {
    near: &'a NearPairs,
    system: CoupledSystem<'a>,
    residual: Residual,
    interrupt: &'a Interrupt,
}

/// Rigid spheres after a displacement, with their loads and the ambient motions.
pub struct DisplacedSpheres<'a> {
    pub cell: &'a PeriodicBox,
    pub particles: &'a Particles,
    pub loads: &'a Loads,
    pub ambient: &'a Motion,
}

/// Spheres at which the system is set up, and a solution whose residual there is wanted.
struct SystemAt<'a> {
    cell: &'a PeriodicBox,
    particles: &'a Particles,
    loads: &'a Loads,
    ambient: &'a Motion,
    found: &'a StoredSolution,
    have_moved: bool,
}

impl CoupledSolver {
    /// The ambient motions for which `solved` is the exact solution under `loads` (backward error), and that solution.
    /// The ambient motions are those of the solve, corrected by its error, plus the effect of the background flow on
    /// the spheres. `solved` has to be the latest solution. Collective.
    pub fn equivalent_ambient(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        loads: &Loads,
        solved: &Solution,
    ) -> Result<(Motion, StoredSolution), SolveError> {
        let units = self.units;
        let motion = Motion { strain_rates: Vec::new(), ..solved.motion.clone() };
        let found = StoredSolution { motion, stresslets_far: solved.far.stresslets.clone(), stresslets: Vec::new() };
        if self.assembles_on_device(cell, particles) {
            return Ok(self.residual_on_device(loads, found));
        }
        let ambient = &NO_AMBIENT;
        self.residual_system(
            &SystemAt { cell, particles, loads, ambient, found: &found, have_moved: false },
            |ResidualSystem { near, residual, .. }| {
                let Residual { stiff, strain_rates, .. } = residual;
                let needed = Motion { velocities: stiff.linear(), angular_velocities: stiff.angular(), strain_rates };
                let stresslets = whole(near, &found, &units);
                Ok((units::motion_back(&needed, &units), StoredSolution { stresslets, ..found.clone() }))
            },
        )
    }

    /// Motions and total stresslets after a small displacement of the rigid spheres, under the same loads and in the
    /// ambient motions for which the original solution is exact, see [`Self::equivalent_ambient`]. With `S(x) l = r(x)`
    /// the system and its original solution, it solves
    ///
    /// ```text
    /// S(x*) dl = r(x*) - S(x*) l
    /// ```
    ///
    /// with an error of `tolerance` relative to the change `dl`, however small that is. Collective; an error is an
    /// error on all ranks.
    pub fn perturbed_solution(
        &mut self,
        at: &DisplacedSpheres,
        found: &StoredSolution,
        tolerance: f64,
    ) -> Result<(Motion, Vec<Traceless>), SolveError> {
        let &DisplacedSpheres { cell, particles, loads, ambient } = at;
        if self.assembles_on_device(cell, particles) {
            return self.perturbed_on_device(at, found, tolerance);
        }
        let (units, comm) = (self.units, self.partition.comm().clone());
        self.residual_system(&SystemAt { cell, particles, loads, ambient, found, have_moved: true }, |left| {
            let ResidualSystem { near, mut system, mut residual, interrupt } = left;
            let limits = Limits { tolerance, iterations: MOST_ITERATIONS, interrupt };
            let count = found.stresslets.len();
            let mut change = unknowns(near, &SixVectors::zero(count), vec![Traceless::ZERO; count]);
            let mut correction = Unknowns::default();
            let iterate = Iterate { x: &mut change, residual: &mut residual, z: &mut correction };
            ended(&conjugate_gradients(&comm, &mut system, iterate, limits), limits)?;
            let solved = system.finish(FinalIterate { x: change, residual, correction }, tolerance, &comm);
            let (velocities, angular_velocities) = (solved.motions.linear(), solved.motions.angular());
            let changed = Motion { velocities, angular_velocities, strain_rates: Vec::new() };
            let mut motion = units::motion_back(&changed, &units);
            motion.add(1.0, &found.motion);
            let far = found.stresslets_far.iter().zip(solved.moments).map(|(&s, d)| s - d * units.torque());
            let there = StoredSolution { motion, stresslets_far: far.collect(), stresslets: Vec::new() };
            let stresslets = whole(near, &there, &units);
            Ok((there.motion, stresslets))
        })
    }

    /// Sets up the system at the positions of `particles` and passes it, with the residual of a solution, to `then`.
    /// The mobility is moved to these positions, and a preconditioner made, only if the spheres have moved.
    fn residual_system<T>(
        &mut self,
        at: &SystemAt,
        then: impl FnOnce(ResidualSystem) -> Result<T, SolveError>,
    ) -> Result<T, SolveError> {
        let &SystemAt { cell, particles, loads, ambient, found, have_moved } = at;
        let (units, own) = (self.units, units::particles(particles, &self.units));
        let scaled_cell = cell.scaled(1.0 / units.length);
        let near = match &mut self.near {
            Some(field) => {
                let view = DomainView { cell: &scaled_cell, partition: &self.partition };
                NearPairs::find(field, Connections::default(), &own, view, StrainRate::default())
            }
            None => NearPairs::none(&own, &scaled_cell, &self.partition),
        };
        let (interrupt, comm) = (self.far.interrupt().clone(), self.partition.comm());
        let mobility = self.far.mobility();
        mobility.constrain(None);
        if have_moved {
            mobility.arrange(cell, particles);
        }
        let spheres = SingleSpheres::new(mobility.plan().viscosity / units.viscosity, &own.radii);
        let is_matrix = have_moved && self.preconditioned && self.near.is_some();
        let matrix = is_matrix.then(|| Preconditioner::new(comm, &near, &spheres.motion, ROUGH));
        let start = guessed(&near, &spheres.motion, &units::found(found, &units));
        let loads = units::times(loads, 1.0 / units.torque());
        let known = SixVectors::new(own.len(), &loads.forces, &loads.torques);
        let scaled = units::motion(ambient, &units);
        let given = SystemStart {
            loads: &known,
            ambient: &scaled,
            quadrupoles: None,
            strain_rate: Traceless::ZERO,
            unknowns: &start,
        };
        let (system, residual) = CoupledSystem::new(Scaled { mobility, units }, &near, matrix, &spheres, given);
        then(ResidualSystem { near: &near, system, residual, interrupt: &interrupt })
    }
}

/// Total stresslets from the motions and the far-field part. Collective.
fn whole(near: &NearPairs, found: &StoredSolution, units: &Units) -> Vec<Traceless> {
    let own = units::motion(&found.motion, units);
    let by_pairs =
        near.stresslets(&SixVectors::new(found.stresslets_far.len(), &own.velocities, &own.angular_velocities));
    found.stresslets_far.iter().zip(by_pairs).map(|(&far, near)| far + near * units.torque()).collect()
}

/// The unknowns of a solution.
fn guessed(near: &NearPairs, single: &[SixVector], found: &StoredSolution) -> Unknowns {
    let motions = SixVectors::new(single.len(), &found.motion.velocities, &found.motion.angular_velocities);
    unknowns(near, &motions, found.stresslets_far.iter().map(|&s| -s).collect())
}
