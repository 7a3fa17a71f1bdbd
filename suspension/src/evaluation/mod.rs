//! Evaluation of the particles' velocities at given positions.

pub mod approach;
mod checks;
pub mod extrapolation;
pub mod fluctuating;
pub mod fluctuating_bodies;
mod following;
pub mod gap_control;
mod given_motions;
pub mod initial_guess;
pub mod orders;
pub mod overlap_monitor;
pub mod prepared;
mod queries;
mod record;
mod relative;
mod remote_forces;
mod remote_motion;
mod remote_noise;
pub mod stage_time;
mod stiffness_adaptation;
pub mod stress;
mod stress_controlled;
mod surface_forces;
mod swimming;
mod tethered;
pub mod velocity_field;

use crate::columns::{self, EXPECTED};
use crate::error::{StartError, step::StepError};
use crate::evaluation::gap_control::watched_range;
use crate::evaluation::initial_guess::WarmStart;
use crate::evaluation::overlap_monitor::OverlapMonitor;
use crate::evaluation::prepared::Setup;
pub use crate::evaluation::stage_time::{Outcome, StageTime};
use crate::flow::periodic_cell::PeriodicCell;
use crate::forces::acting::{Acting, Instant, Prediction, SolvedMotion};
use crate::forces::contacts::Contacts;
use crate::forces::force::Force;
use crate::forces::{Forces, SharedRanges};
use crate::model::box_axes::UserAxes;
use crate::model::{BrownianScheme, Integrator, Model, MultipoleOrder};
use crate::neighbourhood::PairsWithHalo;
use crate::swimmers::Swimmers;
use domain::parallel::stage;
use domain::{DomainView, Interrupt, Interrupted, Particles, Partition};
use fcm::{GUESSED, Motion};
use following::Following;
use given_motions::GivenMotions;
use hydrodynamics::{CoupledSolver, Guess, ShortRange, Solution, SolveInput, Springs};
use lubrication::{LubricationRange, PairKind};
use simulation::Clock;
use std::rc::Rc;

/// Right-hand side of the equation of motion: forces, hydrodynamics and the moving box.
pub struct Dynamics {
    partition: Partition,
    moving: PeriodicCell,
    forces: Forces,
    swimmers: Option<Swimmers>,
    is_implicit: bool,
    /// Whether steps of particles that move here need the pairs of forces here: implicit ones, and Brownian ones with
    /// two evaluations.
    needs_pairs: bool,
    hydrodynamics: CoupledSolver,
    lubrication: Option<LubricationRange>,
    warm_start: WarmStart,
    rigid: bool,
    viscosity: f64,
    smallest_radius: f64,
    largest_radius: f64,
    tolerance: f64,
    /// The key of the model by which particles move here even if the far field can move particles.
    moves_here_by: Option<&'static str>,
    /// Detector of pairs that Brownian motion brings too close to each other.
    overlap_monitor: Option<OverlapMonitor>,
    /// Largest weight of negative eigenvalues that were clipped in the near field of random motions.
    clipped: f64,
    /// Data for replanning when the box follows the particles.
    following: Option<Following>,
    given_motions: GivenMotions,
    axes: UserAxes,
}

/// Comparison of a solution with its guess, see [`fcm::CoupledSolution::compared`].
type Comparison = [[f64; 2]; GUESSED];

/// Results of previous solves: the initial guess of the next one, and the motions of the last one, empty unless forces
/// follow them.
struct PreviousSolutions<'a> {
    guess: Guess,
    motion: &'a Motion,
}

impl Dynamics {
    /// The dynamics of a prepared scene, and its particles.
    pub fn new(model: &Model, setup: Setup) -> Result<(Self, Particles), StartError> {
        let chosen = &model.hydrodynamics;
        let cutoff = chosen.lubrication_cutoff.unwrap_or(LubricationRange::WIDE);
        let range =
            chosen.lubrication.then(|| LubricationRange::new(cutoff, LubricationRange::MINIMUM_GAP)).transpose()?;
        let range = range.map(|range| if model.thermal_energy.is_some() { range.separating() } else { range });
        let overlap_monitor = model.thermal_energy.map(|_| OverlapMonitor::new(model));
        let largest = setup.radii.largest();
        let shared = SharedRanges {
            with_forces: overlap_monitor.as_ref().map(|monitor| monitor.range(largest)),
            others: watched_range(&model.integrator, largest),
        };
        let forces = Forces::of(model)?.sharing(shared).start(model, &setup.particles, &setup.radii, &setup.partition);
        let is_implicit = matches!(model.integrator, Integrator::Implicit(_));
        let springs = forces.implicit_range(setup.radii.largest()).filter(|_| is_implicit);
        let short_range = ShortRange { lubrication: range, springs };
        let hydrodynamics = CoupledSolver::new(&setup.plan, &setup.partition, short_range);
        let hydrodynamics = hydrodynamics.map_err(StartError::Lubrication)?.preconditioned(chosen.preconditioner);
        let mut dynamics = Self {
            hydrodynamics,
            lubrication: range,
            warm_start: WarmStart::new(model.is_coupled()),
            forces: forces.with_fields(&setup.problem, setup.partition.comm())?,
            swimmers: Swimmers::of(model),
            is_implicit,
            needs_pairs: is_implicit || model.integrator == Integrator::Brownian(BrownianScheme::TwoEvaluations),
            rigid: model.hydrodynamics.multipoles == MultipoleOrder::Dipole,
            moves_here_by: model.moves_on_host_by(),
            viscosity: model.viscosity,
            tolerance: model.hydrodynamics.tolerance,
            clipped: 0.0,
            overlap_monitor,
            smallest_radius: setup.radii.smallest(),
            largest_radius: setup.radii.largest(),
            following: Following::of(model, &setup.radii, setup.replan),
            given_motions: GivenMotions::of(model),
            axes: model.user_axes(),
            partition: setup.partition,
            moving: setup.moving,
        };
        dynamics.leave_surface_forces(&setup.particles);
        Ok((dynamics, setup.particles))
    }

    /// Adds the solution at the start of a step to the history, after `steps` previous steps; if there is no history of
    /// these, it fills the whole history.
    pub fn remember(&self, particles: &mut Particles, steps: u64) {
        if self.rigid {
            self.warm_start.remember(particles, steps);
        }
    }

    /// Sets the interrupt that is checked at each evaluation of the mobility.
    pub fn listen(&mut self, interrupt: Interrupt) {
        self.hydrodynamics.listen(interrupt);
    }

    /// Registers a force of the user.
    pub fn register(&mut self, force: Box<dyn Force>) {
        let Self { forces, hydrodynamics, partition, .. } = self;
        let implicit = force.implicit_range(self.largest_radius).filter(|_| self.is_implicit);
        if let Some(range) = implicit {
            hydrodynamics.extend_springs(range);
        }
        forces.register(force, self.largest_radius, partition);
    }

    /// Removes the force that was registered last.
    pub fn remove_last_force(&mut self) {
        self.forces.remove_last(self.largest_radius, &self.partition);
    }

    /// The moving box, as a state to return to.
    pub fn periodic_cell(&self) -> &PeriodicCell {
        &self.moving
    }

    /// Makes velocities relative to the flow, for the time in which particles move, where the far field is evaluated if
    /// they can. If the flow changes at this step, discards the history and evaluates the velocities again. Collective.
    pub fn begin_step(&mut self, particles: &mut Particles, clock: &Clock) -> Result<(), StepError> {
        if self.moving.begin(clock.step()) {
            columns::clear_history(particles);
            self.warm_start.clear_history(particles);
            self.forces.contacts.iter_mut().for_each(Contacts::end_adaptation);
            self.evaluate(particles, &StageTime::in_step(clock, 0.0, 0))?;
            self.move_to_far_field(particles);
        } else {
            // A run that is resumed subtracts the flow where one that goes on does.
            self.move_to_far_field(particles);
            self.add_background(particles, -1.0);
        }
        Ok(())
    }

    /// Makes velocities absolute again and stores the states of flow and contacts.
    pub fn end_step(&mut self, particles: &mut Particles) {
        self.add_background(particles, 1.0);
        let scalars = &mut particles.scalars;
        if let Some(driven) = self.moving.driven() {
            driven.store(scalars);
        }
        if let Some(flux) = self.moving.flux() {
            flux.store(scalars);
        }
        if let Some(adaptation) = self.stiffness_adaptation() {
            adaptation.store(scalars);
        }
    }

    /// Evaluates velocities, angular velocities and stresslets at the time of a clock, between steps. Collective.
    pub fn evaluate_now(&mut self, particles: &mut Particles, clock: &Clock) -> Result<Outcome, StepError> {
        let now = StageTime::in_step(clock, 0.0, self.steps_before(clock));
        let outcome = self.evaluate(particles, &now)?;
        let rate = self.moving.rate();
        if let Some(driven) = self.moving.driven() {
            driven.start_from(rate);
        }
        self.end_step(particles);
        Ok(outcome)
    }

    /// Number of steps in the present flow before the step that begins.
    pub fn steps_before(&self, clock: &Clock) -> u64 {
        clock.step() - self.moving.flow_start_step()
    }

    /// Returns to an earlier state of the box.
    pub fn go_back(&mut self, moving: PeriodicCell) {
        self.moving = moving;
        self.refit();
    }

    /// Wraps particles into the box, migrates them to their ranks, and evaluates their velocities, angular velocities
    /// and stresslets. Collective; fails on every rank or on none.
    pub fn evaluate(&mut self, particles: &mut Particles, moment: &StageTime) -> Result<Outcome, StepError> {
        if self.partition.comm().any(self.hydrodynamics.interrupt().is_requested()) {
            return Err(Interrupted.into());
        }
        self.wrap_and_migrate(particles, moment)?;
        let guess = if self.rigid {
            self.warm_start.guess(particles, &moment.ages, moment.since_last_solution)
        } else {
            Guess::default()
        };
        let follow = self.forces.follow_motion() && !particles.are_remote();
        let motion = if follow { WarmStart::motion(particles) } else { Motion::default() };
        let previous = PreviousSolutions { guess, motion: &motion };
        let (outcome, compared) = match self.moving.search() {
            None => self.solve_at(particles, previous, moment)?,
            Some(search) => (self.drive(particles, search, previous, moment)?, None),
        };
        if self.rigid {
            let (ages, ahead) = (&moment.ages, moment.since_last_solution);
            if compared.is_none() {
                self.fetch(particles);
            }
            self.warm_start.update_blend(particles, ages, ahead, compared, self.partition.comm());
        }
        Ok(outcome)
    }

    /// Brings the numbers of columns that are where the far field is evaluated.
    pub fn fetch(&self, particles: &Particles) {
        self.hydrodynamics.fetch(particles);
    }

    /// Solves for the motions of the particles at their present positions, and writes them into the particles' columns.
    /// Returns a comparison with the guess too, if there is one. Collective.
    fn solve_at(
        &mut self,
        particles: &mut Particles,
        PreviousSolutions { guess, motion }: PreviousSolutions,
        moment: &StageTime,
    ) -> Result<(Outcome, Option<Comparison>), StepError> {
        if particles.are_remote() && self.is_implicit {
            return self.solve_held(particles, guess, moment);
        }
        let expected =
            moment.implicit.map(|time| (time, self.relative(particles, EXPECTED), self.relative_rotation(particles)));
        let strain_rate = self.moving.predicted_strain_rate_change();
        let prediction = expected.as_ref().map(|(time, velocities, angular_velocities)| Prediction {
            time: *time,
            velocities,
            angular_velocities,
            strain_rate,
        });
        let near = if particles.are_remote() { None } else { self.forces.near_in_solves(particles, self.domain()) };
        let acting = self.acting(particles, near.as_ref(), moment, prediction.as_ref(), motion)?;
        drop(near);
        let solved = self.solved(particles, &acting, &acting.ambient, guess, moment)?;
        self.record(particles, &solved);
        if self.forces.follow_motion() {
            self.pass_on_motion(particles, moment)?;
        }
        Ok((Outcome::of(&solved), solved.kept.and_then(|kept| kept.compared)))
    }

    /// Passes the motions in the particles' columns on to the forces that follow them. Collective.
    fn pass_on_motion(&mut self, particles: &mut Particles, moment: &StageTime) -> Result<(), StepError> {
        let motion = &WarmStart::motion(particles);
        let is_stress_controlled = self.moving.driven().is_some();
        let domain = DomainView { cell: self.moving.cell(), partition: &self.partition };
        let solved = SolvedMotion { motion, domain, is_implicit: moment.implicit.is_some(), is_stress_controlled };
        self.forces.solved(particles, &solved, moment.clock.step())
    }

    /// Loads, implicit resistances and ambient motions by all forces, with the near pairs. Particles that move where
    /// the far field is evaluated have only loads that are there. Collective.
    fn acting(
        &mut self,
        particles: &mut Particles,
        near: Option<&PairsWithHalo>,
        moment: &StageTime,
        prediction: Option<&Prediction>,
        previous: &Motion,
    ) -> Result<Acting, StepError> {
        let _stage = stage("forces");
        if particles.are_remote() && self.hydrodynamics.holds_loads() {
            return Ok(Acting::default());
        }
        if self.forces.have_registered() {
            self.fetch(particles);
        }
        let Self { moving, partition, forces, .. } = self;
        let (domain, lists) = (DomainView { cell: moving.cell(), partition }, Rc::clone(forces.lists()));
        let mut at = Instant {
            particles,
            domain,
            near,
            time: moment.clock.time_at(moment.fraction),
            prediction,
            since_last_solution: moment.since_last_solution,
            previous,
            flow: moving,
            lists: &lists,
        };
        forces.acting(&mut at, moment.clock.step())
    }

    /// The motions under the forces, in a fluid with ambient motions.
    fn solved(
        &mut self,
        particles: &mut Particles,
        Acting { loads, resistances, fluctuations, held_forces, .. }: &Acting,
        ambient: &Motion,
        guess: Guess,
        moment: &StageTime,
    ) -> Result<Solution, StepError> {
        let resistance = |distance: f64, between: PairKind| resistances.of_pair(distance, between);
        let (contacts, tethers) = (&resistances.contacts, &resistances.tethers);
        let is_here = held_forces.is_none();
        let springs =
            moment.implicit.filter(|_| is_here).map(|_| Springs { resistance: &resistance, contacts, tethers });
        let (input, constant_flux) = (SolveInput::new(loads, self.moving.strain_rate()), self.moving.keeps_flux());
        let (bodies, squirming) = (self.bodies(particles), self.squirming(particles));
        let (springs, bodies, squirming) = (springs.as_ref(), bodies.as_ref(), squirming.as_ref());
        let surface_forces = self.forces.surfaces_are_solved() || particles.are_remote();
        let moving_in = particles.are_remote().then(|| self.moving.moving_flow());
        let acting = SolveInput {
            springs,
            bodies,
            squirming,
            ambient,
            surface_forces,
            keeps_columns: true,
            moving_in,
            fluctuations: fluctuations.as_ref(),
            held_forces: held_forces.as_ref(),
            constant_flux,
            ..input
        };
        let solved = self.hydrodynamics.solve(self.moving.cell(), particles, &acting, guess);
        let solved = solved.map_err(|source| self.unsolved(source, particles, moment.clock.step()))?;
        if let Some(flux) = self.moving.flux() {
            flux.set_curvature(solved.curvature);
        }
        Ok(solved)
    }

    /// Wraps the particles into the box at an instant, and migrates them to their ranks. Collective.
    pub fn wrap_and_migrate(&mut self, particles: &mut Particles, moment: &StageTime) -> Result<(), StepError> {
        let time = moment.clock.time_at(moment.fraction);
        if self.wrap_remotely(particles, time) {
            return Ok(());
        }
        self.check_positions(particles, &moment.clock)?;
        self.moving.advance_to(time, particles);
        self.follow(particles, &moment.clock)?;
        particles.migrate(&self.partition, self.moving.cell());
        Ok(())
    }
}
