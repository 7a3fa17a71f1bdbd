//! A suspension of spheres in Stokes flow.

mod measurements;
#[cfg(test)]
mod tests;
mod user_forces;

use crate::columns::VELOCITY;
use crate::error::StartError;
use crate::error::step::StepError;
use crate::evaluation::overlap_monitor::OverlapCounts;
use crate::evaluation::prepared::Setup;
use crate::evaluation::velocity_field::FluidVelocity;
use crate::evaluation::{Dynamics, Outcome, StageTime};
use crate::forces::{Forces, tethers, user};
use crate::integrators::adams_bashforth::{self, AdamsBashforth};
use crate::integrators::brownian::{self, BrownianStep, ThermalNoise};
use crate::integrators::{adaptive, implicit};
use crate::model::{Integrator, Model};
use crate::neighbourhood::NearParticles;
use crate::scalars;
use crate::start::{bodies, given_positions, orientations, placement};
use domain::parallel::{of_rows, stage};
use domain::{Comm, GivenPositions, Interrupt, Particles, Partition, PeriodicBox, Vector};
use fcm::PlanError;
use simulation::{Clock, State};

/// Particles, their dynamics, and the time. Between steps the particles' columns hold the velocities, angular
/// velocities and stresslets that belong to their positions.
pub struct Suspension {
    particles: Particles,
    dynamics: Dynamics,
    clock: Clock,
    integrator: Integrator,
    noise_source: Option<ThermalNoise>,
    outcome: Outcome,
    /// Evaluations of the mobility in the last step.
    evaluations: u64,
    caution: Option<String>,
    /// Whether the present velocities, from a resumed state, include user-defined loads.
    has_applied_loads: bool,
    /// Names of registered forces that the present velocities include, after a resumption.
    known_forces: Vec<String>,
    comm: Comm,
}

const OTHER_PLAN: &str = "the fluid is computed in another way than before, so the run goes on, but not bit for bit";

/// Summary of the last step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepReport {
    /// Iterations of the last solve.
    pub iterations: usize,
    /// Relative residual of the last solve.
    pub residual: f64,
    /// Evaluations of the mobility in the last step, over all of its solves.
    pub evaluations: u64,
    /// Relative divergence of the flow of the last evaluation, which is close to round-off. `None` unless the box is
    /// fully periodic, since otherwise the flow on the grid is only a part of the whole.
    pub divergence: Option<f64>,
    /// Smallest gap between the surfaces of two particles.
    pub smallest_gap: f64,
}

impl Suspension {
    /// A suspension at time zero. Collective.
    pub fn start(model: &Model, comm: &Comm) -> Result<Self, StartError> {
        Self::start_with(model, None, comm)
    }

    /// A suspension at time zero, at positions provided by the first rank if the model has [`Start::Given`].
    /// Collective.
    ///
    /// [`Start::Given`]: crate::Start::Given
    pub fn start_with(model: &Model, placed: Option<GivenPositions>, comm: &Comm) -> Result<Self, StartError> {
        let setup = Setup::start(model, placed, comm)?;
        let caution = setup.relaxed();
        let (mut dynamics, mut particles) = Dynamics::new(model, setup)?;
        let clock = Clock::at(0, model.time_step);
        let outcome = dynamics.evaluate_now(&mut particles, &clock)?;
        let (integrator, evaluations) = (model.integrator, dynamics.evaluations());
        Ok(Self {
            particles,
            dynamics,
            clock,
            integrator,
            noise_source: noise_source(model),
            outcome,
            evaluations,
            caution,
            has_applied_loads: false,
            known_forces: Vec::new(),
            comm: comm.clone(),
        })
    }

    /// A suspension in a saved state, in which each rank provides some of the particles; the first rank provides the
    /// state in any case, and ranks without particles may provide nothing. Velocities that are missing in the state are
    /// computed. Collective.
    pub fn resume(model: &Model, state: Option<State>, comm: &Comm) -> Result<Self, StartError> {
        let mut step = state.iter().map(|state| state.step).collect();
        comm.broadcast(&mut step);
        let then = state.as_ref().filter(|_| comm.is_first()).map(|state| state.plan.clone());
        let mut particles = state.map(|state| state.particles).unwrap_or_default();
        comm.agree(given_positions::check(&particles, model.species.len(), model.is_coupled()))?;
        let is_tied = if comm.is_first() { tethers::check(&particles, model) } else { Ok(()) };
        let is_oriented = if comm.is_first() { orientations::check(&particles, model) } else { Ok(()) };
        let has_bodies = if comm.is_first() { bodies::check(&particles, model) } else { Ok(()) };
        comm.agree(has_bodies)?;
        comm.agree(is_tied)?;
        comm.agree(is_oriented)?;
        placement::share_columns(&mut particles, comm);
        scalars::restore(&mut particles, comm);
        let (dynamics, particles) = Dynamics::new(model, Setup::at(model, particles, comm, step[0])?)?;
        let clock = Clock::at(step[0], model.time_step);
        let (integrator, outcome, comm) = (model.integrator, Outcome::default(), comm.clone());
        let (has_applied_loads, known_forces) = (user::is_among(&particles), Forces::registered_in(&particles));
        let mut resumed = Self {
            particles,
            dynamics,
            clock,
            integrator,
            noise_source: noise_source(model),
            outcome,
            evaluations: 0,
            caution: None,
            has_applied_loads,
            known_forces,
            comm,
        };
        if then.is_some_and(|plan| !resumed.dynamics.has_plan(&plan)) {
            resumed.caution = Some(OTHER_PLAN.to_owned());
        }
        if !resumed.particles.columns.iter().any(|column| column.name == VELOCITY) {
            resumed.outcome = resumed.dynamics.evaluate_now(&mut resumed.particles, &resumed.clock)?;
        }
        Ok(resumed)
    }

    /// A warning about the way in which the run starts or continues, on the first rank.
    pub fn caution(&self) -> Option<&str> {
        self.caution.as_deref()
    }

    /// Sets the interrupt that is checked at each evaluation of the mobility.
    pub fn listen(&mut self, interrupt: Interrupt) {
        self.dynamics.listen(interrupt);
    }

    /// Takes one step. `Err` on every rank or on none. A step that fails or is interrupted has no effect: the state
    /// before it is restored bit for bit.
    pub fn step(&mut self) -> Result<(), StepError> {
        self.step_seen(true)
    }

    /// [`Self::step`] with the option to skip results: unless `is_seen`, columns on which later steps do not depend may
    /// keep the motions of an earlier step. The next step is bitwise the same in either case.
    pub fn step_seen(&mut self, is_seen: bool) -> Result<(), StepError> {
        self.or_as_before(|suspension| suspension.take_step(is_seen))
    }

    /// Applies a change; if it fails, restores the state before it.
    fn or_as_before(&mut self, change: impl FnOnce(&mut Self) -> Result<(), StepError>) -> Result<(), StepError> {
        let copying = stage("copy of the state");
        self.particles.save(&self.comm);
        let moving = self.dynamics.periodic_cell().clone();
        drop(copying);
        let adaptation = self.dynamics.stiffness_adaptation();
        let changed = change(self);
        if changed.is_ok() {
            self.particles.forget();
        } else {
            self.particles.restore(&self.comm);
            self.dynamics.go_back(moving);
            self.dynamics.set_adaptation(adaptation);
        }
        changed
    }

    fn take_step(&mut self, is_seen: bool) -> Result<(), StepError> {
        let _stage = stage("integration");
        let Self { particles, dynamics, clock, outcome, integrator, noise_source, .. } = self;
        let before = dynamics.evaluations();
        dynamics.begin_step(particles, clock)?;
        *outcome = match integrator {
            Integrator::Adaptive(control) => adaptive::advance(particles, clock, control, dynamics)?,
            Integrator::Implicit(control) => implicit::advance(particles, clock, control, dynamics)?,
            Integrator::Brownian(scheme) => {
                let noise_source = noise_source.expect("a model whose steps are Brownian has thermal noise");
                let step = BrownianStep { noise_source, scheme: *scheme, is_seen };
                brownian::advance(particles, clock, step, dynamics)?
            }
            Integrator::AdamsBashforth { order } => {
                fixed_step(particles, clock, AdamsBashforth::of_order(*order), dynamics)?
            }
        };
        dynamics.end_step(particles);
        dynamics.end_forces(particles, clock.step())?;
        self.evaluations = dynamics.evaluations() - before;
        self.clock.tick();
        self.has_applied_loads = false;
        self.known_forces.clear();
        Ok(())
    }

    /// Time and step.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Communicator of the ranks.
    pub fn comm(&self) -> &Comm {
        &self.comm
    }

    /// Present box.
    pub fn cell(&self) -> &PeriodicBox {
        self.dynamics.cell()
    }

    /// Particles of this rank, with the numbers of all columns.
    pub fn particles(&self) -> &Particles {
        self.dynamics.fetch(&self.particles);
        &self.particles
    }

    /// Partition of the box among ranks.
    pub(crate) fn partition(&self) -> &Partition {
        self.dynamics.partition()
    }

    /// Particles within a distance of each of this rank's particles. Collective.
    pub(crate) fn near(&self, distance: f64) -> NearParticles {
        self.dynamics.forces().lists().near(self.particles(), self.dynamics.domain(), distance)
    }

    /// Description of the numerical method.
    pub fn plan(&mut self) -> String {
        self.dynamics.plan()
    }

    /// All particles in the order of their ids, on the first rank, with all or the named columns. Collective.
    pub fn gathered(&self, columns: Option<&[&str]>) -> Particles {
        let wanted = |name: &str| columns.is_none_or(|names| names.contains(&name));
        self.particles().gathered_with(self.dynamics.partition(), wanted)
    }

    /// State of the suspension, with the particles of this rank.
    pub fn state(&mut self) -> State {
        let plan = self.plan();
        let (step, strain, mut particles) =
            (self.clock.step(), self.cell().strain(), self.particles().clone().detached());
        scalars::save(&mut particles);
        State { step, strain, plan, particles, statistics: Vec::new() }
    }

    /// Velocities of this rank's particles relative to the background flow at their positions.
    pub fn velocities_in_flow(&self) -> Vec<Vector> {
        let particles = self.particles();
        let column = particles.columns.iter().find(|c| c.name == VELOCITY).expect("velocities were computed");
        let velocities: &[Vector] = bytemuck::cast_slice(&column.values);
        let moving = self.dynamics.periodic_cell();
        let (positions, radii) = (&particles.positions, &particles.radii);
        of_rows(velocities.len(), |row| velocities[row] - moving.velocity_of(positions[row], radii[row]))
    }

    /// Rate of shear or extension to which the velocities belong, and the strain so far.
    pub fn shear(&self) -> [f64; 2] {
        let moving = self.dynamics.periodic_cell();
        [moving.rate(), moving.strain(self.clock.time())]
    }

    /// Whether the flow has almost stopped under its stress.
    pub fn is_jammed(&self) -> bool {
        self.dynamics.periodic_cell().is_jammed()
    }

    /// Largest weight left out of random motions so far, relative to the total: that of negative eigenvalues of the
    /// near field, which occur if spheres overlap.
    pub fn clipped(&self) -> f64 {
        self.dynamics.clipped()
    }

    /// Pairs that overlapped, or almost, in the last Brownian solve; `None` without Brownian motion.
    pub(crate) fn overlap_counts(&self) -> Option<OverlapCounts> {
        self.dynamics.overlap_counts()
    }

    /// Summary of the last step. Collective.
    pub fn report(&mut self) -> StepReport {
        StepReport {
            iterations: self.outcome.iterations,
            residual: self.outcome.residual,
            evaluations: self.evaluations,
            divergence: self.dynamics.divergence(),
            smallest_gap: self.dynamics.smallest_gap(self.particles()),
        }
    }

    /// Velocity of the fluid relative to the background flow, on the first rank. Fails if no grid can resolve it.
    /// Collective.
    pub fn velocity_field(&mut self) -> Result<FluidVelocity, PlanError> {
        self.dynamics.fetch(&self.particles);
        self.dynamics.velocity_field(&self.particles, self.clock.time())
    }
}

/// Thermal fluctuations of a model, if there are any.
fn noise_source(model: &Model) -> Option<ThermalNoise> {
    model.thermal_energy.map(|energy| ThermalNoise { energy, seed: model.seed })
}

/// One step of a method with fixed steps.
fn fixed_step(
    particles: &mut Particles,
    clock: &Clock,
    method: AdamsBashforth,
    dynamics: &mut Dynamics,
) -> Result<Outcome, StepError> {
    let steps = dynamics.steps_before(clock);
    dynamics.remember(particles, steps);
    adams_bashforth::advance(particles, clock.dt(), steps, method, &mut |particles, fraction| {
        dynamics.evaluate(particles, &StageTime::in_step(clock, fraction, steps)).map(drop)
    })?;
    dynamics.reorient(particles, clock);
    dynamics.evaluate(particles, &StageTime::in_step(clock, 1.0, steps))
}
