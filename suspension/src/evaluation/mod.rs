//! Evaluation of the particles' velocities at given positions.

mod checks;
pub mod extrapolation;
pub mod fluctuating;
mod following;
pub mod gap_control;
pub mod initial_guess;
pub mod orders;
pub mod overlap_monitor;
pub mod prepared;
mod queries;
pub mod stage_time;
mod stiffness_adaptation;
pub mod stress;
mod stress_controlled;
mod tethered;
pub mod velocity_field;

use crate::columns;
use crate::columns::EXPECTED;
use crate::columns::{ANGULAR_VELOCITY, STRESSLET, VELOCITY};
use crate::error::StartError;
use crate::error::gap::Gap;
use crate::error::step::StepError;
use crate::evaluation::gap_control::{RelativeMotion, WATCHED};
use crate::evaluation::initial_guess::WarmStart;
use crate::evaluation::overlap_monitor::OverlapMonitor;
use crate::evaluation::prepared::Setup;
pub use crate::evaluation::stage_time::{Outcome, StageTime};
use crate::flow::periodic_cell::PeriodicCell;
use crate::forces::contacts::{self, Contacts, StiffnessAdaptation};
use crate::forces::tethers::Tethers;
use crate::forces::user::AppliedForces;
use crate::forces::{Forces, Prediction};
use crate::model::box_axes::UserAxes;
use crate::model::{self, Integrator, Model, Multipoles};
use crate::neighbourhood::NearLists;
use domain::{Interrupt, Interrupted, Particles, Partition, Vector};
use fcm::{Loads, Motion, SolveError};
use following::Following;
use hydrodynamics::TetherResistance;
use hydrodynamics::{ContactSprings, CoupledSolver, Guess, NO_AMBIENT, ShortRange, Solution, SolveInput, Springs};
use lubrication::{LubricationRange, PairKind};
use simulation::Clock;

/// Right-hand side of the equation of motion: forces, hydrodynamics and the moving box.
pub struct Dynamics {
    partition: Partition,
    moving: PeriodicCell,
    forces: Forces,
    contacts: Option<Contacts>,
    tethers: Tethers,
    applied: AppliedForces,
    hydrodynamics: CoupledSolver,
    lubrication: Option<LubricationRange>,
    warm_start: WarmStart,
    rigid: bool,
    viscosity: f64,
    smallest_radius: f64,
    tolerance: f64,
    /// Detector of pairs that Brownian motion brings too close to each other.
    crowding: Option<OverlapMonitor>,
    /// Largest weight of negative eigenvalues that were clipped in the near field of random motions.
    clipped: f64,
    /// Neighbour lists of the pairs whose relative motion limits steps.
    watched: NearLists,
    /// Data for replanning when the box follows the particles.
    following: Option<Following>,
    axes: UserAxes,
}

impl Dynamics {
    /// The dynamics of a prepared scene, and its particles.
    pub fn new(model: &Model, setup: Setup) -> Result<(Self, Particles), StartError> {
        let chosen = &model.hydrodynamics;
        let cutoff = chosen.lubrication_cutoff.unwrap_or(LubricationRange::WIDE);
        let range =
            chosen.lubrication.then(|| LubricationRange::new(cutoff, LubricationRange::MINIMUM_GAP)).transpose()?;
        let range = range.map(|range| if model.thermal_energy.is_some() { range.separating() } else { range });
        let forces = Forces::new(model, setup.radii.largest(), &setup.partition)?;
        let is_implicit = matches!(model.integrator, Integrator::Implicit(_));
        let radii = [setup.radii.smallest(), setup.radii.largest()];
        let settling = StiffnessAdaptation::of(model, &setup.particles, setup.partition.comm());
        let of_law = |contacts: model::Contacts| Contacts::new(contacts.contact(model), (radii, setup.radii.count()));
        let contacts = model.contacts.map(|contacts| of_law(contacts).settling(settling));
        let tethers = Tethers::new(model, &setup.particles, setup.partition.comm());
        let reaches = [forces.reach_of_springs(setup.radii.largest()), tethers.reach(setup.radii.largest())];
        let crowding =
            model.thermal_energy.map(|_| OverlapMonitor::new(model, setup.radii.largest(), &setup.partition));
        let springs = reaches.into_iter().flatten().reduce(f64::max).filter(|_| is_implicit);
        let short_range = ShortRange { lubrication: range, springs };
        let hydrodynamics = CoupledSolver::new(&setup.plan, &setup.partition, short_range);
        let hydrodynamics = hydrodynamics.map_err(StartError::Lubrication)?;
        let dynamics = Self {
            hydrodynamics: hydrodynamics.preconditioned(chosen.preconditioner),
            lubrication: range,
            warm_start: WarmStart::new(model.is_coupled()),
            forces,
            contacts,
            tethers,
            applied: AppliedForces::new(model.user_axes()),
            rigid: model.hydrodynamics.multipoles == Multipoles::Dipole,
            viscosity: model.viscosity,
            tolerance: model.hydrodynamics.tolerance,
            clipped: 0.0,
            crowding,
            smallest_radius: setup.radii.smallest(),
            watched: NearLists::new(WATCHED * setup.radii.largest(), &setup.partition),
            following: Following::of(model, &setup.radii, setup.replan),
            axes: model.user_axes(),
            partition: setup.partition,
            moving: setup.moving,
        };
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

    /// User-defined loads.
    pub fn applied(&mut self) -> &mut AppliedForces {
        &mut self.applied
    }

    /// The moving box, as a state to return to.
    pub fn periodic_cell(&self) -> &PeriodicCell {
        &self.moving
    }

    /// Makes velocities relative to the flow, for the time in which particles move. If the flow changes at this step,
    /// discards the history and evaluates the velocities again. Collective.
    pub fn begin_step(&mut self, particles: &mut Particles, clock: &Clock) -> Result<(), StepError> {
        if self.moving.begin(clock.step()) {
            columns::clear_history(particles);
            self.warm_start.forget(particles);
            self.contacts.iter_mut().for_each(Contacts::end_settling);
            self.evaluate(particles, &StageTime::in_step(clock, 0.0, 0))?;
        } else {
            self.add_reference(particles, -1.0);
        }
        Ok(())
    }

    /// Makes velocities absolute again and stores the states of flow and contacts in the particles' columns.
    pub fn end_step(&mut self, particles: &mut Particles) {
        self.add_reference(particles, 1.0);
        if let Some(driven) = self.moving.driven() {
            driven.note(particles);
        }
        if let Some(flux) = self.moving.flux() {
            flux.note(particles);
        }
        if let Some(settling) = self.settling() {
            settling.note(particles);
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
        clock.step() - self.moving.began()
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
        self.place(particles, moment)?;
        let guess =
            if self.rigid { self.warm_start.guess(particles, &moment.ages, moment.ahead) } else { Guess::default() };
        let before = self.contacts.as_ref().map(|_| WarmStart::motion(particles)).unwrap_or_default();
        let outcome = match self.moving.search() {
            None => self.solve_at(particles, (&guess, &before), moment)?.0,
            Some(search) => self.drive(particles, (search, guess, &before), moment)?,
        };
        if self.rigid {
            self.warm_start.learn(particles, &moment.ages, moment.ahead, self.partition.comm());
        }
        Ok(outcome)
    }

    /// Solves for the motions of the particles at their present positions, given the motions of the previous solution.
    /// Returns the statistics of the solve and, under stress control, the `xy` component of the first moments of this
    /// rank's contacts. Collective.
    fn solve_at(
        &mut self,
        particles: &mut Particles,
        (guess, before): (&Guess, &Motion),
        moment: &StageTime,
    ) -> Result<(Outcome, f64), StepError> {
        let cell = *self.moving.cell();
        let expected = moment.implicit.map(|time| (time, self.relative(particles, EXPECTED)));
        let besides = self.moving.expected_besides();
        let ahead =
            expected.as_ref().map(|(time, velocities)| Prediction { time: *time, velocities, strain_rate: besides });
        let (mut loads, tethers) = self.loads_at(particles, moment, ahead.as_ref())?;
        let Some(contacts) = &self.contacts else {
            let resisting = (&[][..], &tethers);
            return Ok((self.solve(particles, (&loads, resisting), guess, moment)?, 0.0));
        };
        let [across, along] = moment.implicit.map_or([0.0; 2], |time| [moment.ahead, time]);
        let velocities = expected.as_ref().map_or(&[][..], |(_, velocities)| velocities);
        let flow = contacts::Flow::of(&self.moving, besides);
        let with = (contacts::PredictionTimes { along, across }, velocities, flow);
        let touching = contacts.acting(particles, (&cell, &self.partition), with, before);
        touching.add_to(&mut loads);
        let outcome = self.solve(particles, (&loads, (&touching.springs(), &tethers)), guess, moment)?;
        let motion = WarmStart::motion(particles);
        if moment.implicit.is_some() {
            let noted = touching.note(particles, &motion);
            self.partition.comm().agree(noted).map_err(StepError::Contacts)?;
        }
        let of_contacts = if self.moving.driven().is_some() { touching.shear_moment(&motion) } else { 0.0 };
        Ok((outcome, of_contacts))
    }

    /// Forces and torques of the model and of the user, and the implicit resistances of bonds and traps. Collective.
    fn loads_at(
        &mut self,
        particles: &mut Particles,
        moment: &StageTime,
        ahead: Option<&Prediction>,
    ) -> Result<(Loads, TetherResistance), StepError> {
        let (place, clock) = ((self.moving.cell(), &self.partition), &moment.clock);
        let mut loads = self.forces.on(particles, place, ahead);
        let resisting = self.tethers.add_to(&mut loads, particles, place, ahead);
        let resisting = resisting.map_err(|source| StepError::Bonds { step: clock.step(), source })?;
        let applied = self.applied.add_to(&mut loads, particles, place, clock.time_at(moment.fraction));
        applied.map_err(|source| StepError::Applied { step: clock.step(), source })?;
        Ok((loads, resisting))
    }

    /// Solves for the motions under loads and implicit springs, and writes them into the particles' columns.
    fn solve(
        &mut self,
        particles: &mut Particles,
        (loads, springs): (&Loads, (&[Vec<ContactSprings>], &TetherResistance)),
        guess: &Guess,
        moment: &StageTime,
    ) -> Result<Outcome, StepError> {
        let solved = self.solved(particles, (loads, springs, &NO_AMBIENT), guess, moment)?;
        self.record(particles, &solved);
        Ok(Outcome::of(&solved))
    }

    /// The motions under loads and implicit springs, in a fluid with further ambient motions.
    fn solved(
        &mut self,
        particles: &mut Particles,
        (loads, (contacts, tethers), ambient): (&Loads, (&[Vec<ContactSprings>], &TetherResistance), &Motion),
        guess: &Guess,
        moment: &StageTime,
    ) -> Result<Solution, StepError> {
        let surface = self.forces.surface();
        let resistance =
            moment.implicit.map(|time| move |d: f64, between: PairKind| surface.resistance(time, d, between));
        let springs = resistance.as_ref().map(|resistance| Springs { resistance, contacts, tethers });
        let (strain_rate, constant_flux) = (self.moving.strain_rate(), self.moving.keeps_flux());
        let acting = SolveInput { loads, strain_rate, springs: springs.as_ref(), ambient, constant_flux };
        let solved = self.hydrodynamics.solve(self.moving.cell(), particles, &acting, guess);
        let solved = solved.map_err(|source| self.unsolved(source, particles, moment.clock.step()))?;
        if let Some(flux) = self.moving.flux() {
            flux.set_curvature(solved.curvature);
        }
        Ok(solved)
    }

    /// Wraps the particles into the box at an instant, and migrates them to their ranks. Collective.
    pub fn place(&mut self, particles: &mut Particles, moment: &StageTime) -> Result<(), StepError> {
        self.check_positions(particles, &moment.clock)?;
        self.moving.go_to(moment.clock.time_at(moment.fraction), particles);
        self.follow(particles, &moment.clock)?;
        particles.migrate(&self.partition, self.moving.cell());
        Ok(())
    }

    /// A column of velocities minus the background flow, as far as the column contains it.
    fn relative(&self, particles: &mut Particles, name: &str) -> Vec<Vector> {
        let velocities = particles.vectors(name).to_vec();
        let places = particles.positions.iter().zip(&particles.radii);
        velocities.iter().zip(places).map(|(&v, (&x, &a))| v - self.moving.carried_velocity_of(x, a)).collect()
    }

    /// Adds `times` the flow relative to which velocities are given while particles move.
    fn add_reference(&self, particles: &mut Particles, times: f64) {
        if !self.moving.carries() {
            return;
        }
        let reference: Vec<_> = particles.positions.iter().map(|&x| self.flow().velocity(x) * times).collect();
        particles.vectors(VELOCITY).iter_mut().zip(reference).for_each(|(v, reference)| *v += reference);
    }

    /// The error for a failed solve: an overlap, if there is one. Collective.
    pub(super) fn unsolved(&self, source: SolveError, particles: &mut Particles, step: u64) -> StepError {
        if let SolveError::Interrupted(interrupted) = source {
            return interrupted.into();
        }
        let nothing = [[0.0]; 2];
        let gap = self.approach(particles, [VELOCITY]).after(nothing, [0.0; 2], self.partition.comm()).gap;
        if gap < 0.0 { StepError::Overlap { step, overlap: self.gap(-gap) } } else { StepError::Solve { step, source } }
    }

    /// A gap or an overlap, for messages.
    pub(super) fn gap(&self, length: f64) -> Gap {
        Gap { length, radius: self.smallest_radius }
    }

    /// Writes a solution into the particles' columns. Angular velocities include the background flow; velocities
    /// include it unless they are relative to it while particles move.
    fn record(&self, particles: &mut Particles, solved: &Solution) {
        self.note_carried(particles, VELOCITY, &solved.motion.velocities);
        if self.rigid {
            let own = &solved.motion.angular_velocities;
            let turned = particles.positions.iter().zip(own).map(|(&x, &own)| own + self.moving.angular_velocity_at(x));
            let turned: Vec<_> = turned.collect();
            particles.vectors(ANGULAR_VELOCITY).copy_from_slice(&turned);
            let stresslets: &[f64] = bytemuck::cast_slice(&solved.stresslets);
            particles.column(STRESSLET, 5).values.copy_from_slice(stresslets);
            self.warm_start.record(particles, solved);
        }
    }

    /// Writes velocities into a column, with the background flow that columns of velocities contain.
    fn note_carried(&self, particles: &mut Particles, column: &str, velocities: &[Vector]) {
        let places = particles.positions.iter().zip(&particles.radii).zip(velocities);
        let carried: Vec<_> = places.map(|((&x, &a), &v)| v + self.moving.carried_velocity_of(x, a)).collect();
        particles.vectors(column).copy_from_slice(&carried);
    }

    /// Relative motion of near pairs with the velocities of the named columns. Collective.
    pub fn approach<const N: usize>(&self, particles: &mut Particles, columns: [&str; N]) -> RelativeMotion<N> {
        let near = self.watched.find(particles, (self.moving.cell(), &self.partition));
        RelativeMotion::new(near, particles, &self.moving, columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, Species, Start};
    use domain::Comm;
    use domain::PeriodicBox;
    use std::error::Error;

    /// A failed solve is explained by an overlap, or by another reason.
    #[test]
    fn spheres_that_overlap_are_named_where_no_flow_is_found() {
        let cell = PeriodicBox::new(Vector::splat(14.0)).unwrap();
        let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 2)], (0.05, 6));
        let start = Start::Positions(vec![Vector::splat(3.0), Vector::new(6.5, 3.0, 3.0)]);
        let model = Model::new(Parameters { start, ..usual }).unwrap();
        let (dynamics, mut particles) =
            Dynamics::new(&model, Setup::start(&model, None, &Comm::alone()).unwrap()).unwrap();
        for (distance, said) in
            [(3.5, "step 7: the motion"), (1.5, "step 7: spheres overlap by 0.5 (0.5 of the smallest radius), and")]
        {
            particles.positions[1] = particles.positions[0] + Vector::X * distance;
            let error = dynamics.unsolved(SolveError::NotFinite, &mut particles, 7);
            let cause = error.source().map_or_else(String::new, |cause| format!(": {cause}"));
            let message = format!("{error}{cause}");
            assert!(message.starts_with(said), "{message}");
        }
    }
}
