//! From positions to velocities.

mod drive;
mod fluctuating;
mod following;
mod settling;
mod tethered;

use crate::applied::{self, AppliedForces};
use crate::columns::{ANGULAR_VELOCITY, STRESSLET, VELOCITY};
use crate::contacts::{self, Contacts, Measured, Settling};
use crate::crowding::Crowding;
use crate::error::StartError;
use crate::fluid::{self, FluidVelocity};
use crate::forces::{Ahead, Forces, Surface};
use crate::gap::Gap;
use crate::hydrodynamics::{Acting, ContactSprings, Guess, Hydrodynamics, STILL, ShortRange, Solved, Springs};
use crate::integrator::{self, EXPECTED};
use crate::model::{self, Integrator, Model, Multipoles};
use crate::moving_box::MovingBox;
use crate::near::NearLists;
use crate::relative_motion::{RelativeMotion, WATCHED};
use crate::setup::Setup;
use crate::step_error::StepError;
use crate::substeps;
use crate::tethers::{TetherResistance, Tethers};
use crate::user_axes::UserAxes;
use crate::warm_start::WarmStart;
use domain::{Boundaries, Interrupt, Interrupted, Number, Particles, Partition, PeriodicBox, Tensor, Vector};
use fcm::{Loads, Motion, PlanError, SolveError};
use following::Following;
use lubrication::{Range, Surfaces};
use simulation::Clock;
use solver::BackgroundFlow;

/// Edges of the box that a particle may be away from it at the end of a step, as far as counting them goes.
const FARTHEST: f64 = 1e9;

/// Distance of a sphere's centre from a wall, in radii, below which it has sunk into it: at 0.8 the mobility of its envelopes is
/// no longer positive.
const SUNK: f64 = 0.85;

/// How the solve of one evaluation went.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Outcome {
    /// Iterations for the stresslets.
    pub iterations: usize,
    /// Their relative residual.
    pub residual: f64,
}

impl Outcome {
    fn of(solved: &Solved) -> Self {
        Self { iterations: solved.iterations, residual: solved.residual }
    }
}

/// When an evaluation is made.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// The clock at the start of its step.
    pub clock: Clock,
    /// How much of that step is over.
    pub fraction: f64,
    /// How old the solutions that were remembered were when the last of them was: 0 first.
    pub ages: Vec<f64>,
    /// The time since then.
    pub ahead: f64,
    /// The time by which forces between near spheres are to be ahead of this moment, where they are in the solve: they are
    /// taken with the velocities solved for instead of those in the column [`EXPECTED`].
    pub implicit: Option<f64>,
}

impl Moment {
    /// When a fraction of a step is over, solutions being remembered at the start of each of so many steps before.
    pub fn in_step(clock: &Clock, fraction: f64, steps: u64) -> Self {
        let ages = (0..=steps.min(2)).map(|k| k as f64 * clock.dt()).collect();
        Self { clock: *clock, fraction, ages, ahead: fraction * clock.dt(), implicit: None }
    }
}

/// Everything that moves the particles.
pub struct Dynamics {
    partition: Partition,
    moving: MovingBox,
    forces: Forces,
    contacts: Option<Contacts>,
    tethers: Tethers,
    applied: AppliedForces,
    hydrodynamics: Hydrodynamics,
    lubrication: Option<Range>,
    warm_start: WarmStart,
    rigid: bool,
    viscosity: f64,
    smallest_radius: f64,
    tolerance: f64,
    /// Pairs that heat brings too near each other.
    crowding: Option<Crowding>,
    /// The largest weight of negative eigenvalues in the near field of random motions.
    clipped: f64,
    /// Pairs whose relative motion limits steps.
    watched: NearLists,
    /// Where the box follows the particles.
    following: Option<Following>,
    axes: UserAxes,
}

impl Dynamics {
    /// The dynamics of a scene that was made ready, and its particles.
    pub fn new(model: &Model, setup: Setup) -> Result<(Self, Particles), StartError> {
        let chosen = &model.hydrodynamics;
        let cutoff = chosen.lubrication_cutoff.unwrap_or(Range::WIDE);
        let range = chosen.lubrication.then(|| Range::new(cutoff, Range::CLOSEST)).transpose()?;
        let range = range.map(|range| if model.thermal_energy.is_some() { range.parting() } else { range });
        let forces = Forces::new(model, setup.radii.largest(), &setup.partition)?;
        let is_implicit = matches!(model.integrator, Integrator::Implicit(_));
        let radii = [setup.radii.smallest(), setup.radii.largest()];
        let settling = Settling::of(model, &setup.particles, setup.partition.comm());
        let of_law = |contacts: model::Contacts| Contacts::new(contacts.contact(model), (radii, setup.radii.count()));
        let contacts = model.contacts.map(|contacts| of_law(contacts).settling(settling));
        let tethers = Tethers::new(model, &setup.particles, setup.partition.comm());
        let reaches = [forces.reach_of_springs(setup.radii.largest()), tethers.reach(setup.radii.largest())];
        let crowding = model.thermal_energy.map(|_| Crowding::new(model, setup.radii.largest(), &setup.partition));
        let springs = reaches.into_iter().flatten().reduce(f64::max).filter(|_| is_implicit);
        let short_range = ShortRange { lubrication: range, springs };
        let hydrodynamics = Hydrodynamics::new(&setup.plan, &setup.partition, short_range);
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
            following: Following::of(model, &setup.radii),
            axes: model.user_axes(),
            partition: setup.partition,
            moving: setup.moving,
        };
        Ok((dynamics, setup.particles))
    }

    /// Makes the state at the start of a step part of the past, after so many steps; where nothing is known of those,
    /// all of it.
    pub fn remember(&self, particles: &mut Particles, steps: u64) {
        if self.rigid {
            self.warm_start.remember(particles, steps);
        }
    }

    /// Looks at this interrupt at each evaluation of the mobility from now on.
    pub fn listen(&mut self, interrupt: Interrupt) {
        self.hydrodynamics.listen(interrupt);
    }

    /// Loads that the user adds.
    pub fn applied(&mut self) -> &mut AppliedForces {
        &mut self.applied
    }

    /// Where the box is in time, to go back to.
    pub fn moving_box(&self) -> &MovingBox {
        &self.moving
    }

    /// Makes velocities what they are while particles move, and the flow what it is from the step on that begins, if it
    /// changes then: nothing of the past goes on, and the velocities are computed again. Collective.
    pub fn begin_step(&mut self, particles: &mut Particles, clock: &Clock) -> Result<(), StepError> {
        if self.moving.begin(clock.step()) {
            integrator::forget(particles);
            substeps::forget(particles);
            self.warm_start.forget(particles);
            self.contacts.iter_mut().for_each(Contacts::end_settling);
            self.evaluate(particles, &Moment::in_step(clock, 0.0, 0))?;
        } else {
            self.add_reference(particles, -1.0);
        }
        Ok(())
    }

    /// Makes the velocities at the end of a step those that others see.
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

    /// Computes velocities, angular velocities and stresslets at the time of a clock, between steps. Collective.
    pub fn evaluate_now(&mut self, particles: &mut Particles, clock: &Clock) -> Result<Outcome, StepError> {
        let now = Moment::in_step(clock, 0.0, self.steps_before(clock));
        let outcome = self.evaluate(particles, &now)?;
        let rate = self.moving.rate();
        if let Some(driven) = self.moving.driven() {
            driven.start_from(rate);
        }
        self.end_step(particles);
        Ok(outcome)
    }

    /// Steps of the present flow before that which begins.
    pub fn steps_before(&self, clock: &Clock) -> u64 {
        clock.step() - self.moving.began()
    }

    /// Goes back to a box of the past.
    pub fn go_back(&mut self, moving: MovingBox) {
        self.moving = moving;
        self.refit();
    }

    /// Brings the particles into the box and to their ranks, and computes their velocities, angular velocities and
    /// stresslets at a moment. Collective; fails on every rank or on none.
    pub fn evaluate(&mut self, particles: &mut Particles, moment: &Moment) -> Result<Outcome, StepError> {
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

    /// Solves for the motions of particles where they are, after those of a solution before. How that went, and where a stress
    /// drives the flow, the `xy` component of the first moments of this rank's contacts. Collective.
    fn solve_at(
        &mut self,
        particles: &mut Particles,
        (guess, before): (&Guess, &Motion),
        moment: &Moment,
    ) -> Result<(Outcome, f64), StepError> {
        let cell = *self.moving.cell();
        let expected = moment.implicit.map(|time| (time, self.relative(particles, EXPECTED)));
        let besides = self.moving.expected_besides();
        let ahead = expected.as_ref().map(|(time, velocities)| Ahead { time: *time, velocities, strain_rate: besides });
        let (mut loads, tethers) = self.loads_at(particles, moment, ahead.as_ref())?;
        let Some(contacts) = &self.contacts else {
            let resisting = (&[][..], &tethers);
            return Ok((self.solve(particles, (&loads, resisting), guess, moment)?, 0.0));
        };
        let [across, along] = moment.implicit.map_or([0.0; 2], |time| [moment.ahead, time]);
        let velocities = expected.as_ref().map_or(&[][..], |(_, velocities)| velocities);
        let flow = contacts::Flow::of(&self.moving, besides);
        let with = (contacts::Ahead { along, across }, velocities, flow);
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

    /// Forces and torques of the model and the user's at a moment, and what bonds and traps resist. Collective.
    fn loads_at(
        &mut self,
        particles: &mut Particles,
        moment: &Moment,
        ahead: Option<&Ahead>,
    ) -> Result<(Loads, TetherResistance), StepError> {
        let (place, clock) = ((self.moving.cell(), &self.partition), &moment.clock);
        let mut loads = self.forces.on(particles, place, ahead);
        let resisting = self.tethers.add_to(&mut loads, particles, place, ahead);
        let resisting = resisting.map_err(|source| StepError::Bonds { step: clock.step(), source })?;
        let applied = self.applied.add_to(&mut loads, particles, place, clock.time_at(moment.fraction));
        applied.map_err(|source| StepError::Applied { step: clock.step(), source })?;
        Ok((loads, resisting))
    }

    /// Solves for the motions under loads, with what springs resist, and writes them into the particles' columns.
    fn solve(
        &mut self,
        particles: &mut Particles,
        (loads, springs): (&Loads, (&[Vec<ContactSprings>], &TetherResistance)),
        guess: &Guess,
        moment: &Moment,
    ) -> Result<Outcome, StepError> {
        let solved = self.solved(particles, (loads, springs, &STILL), guess, moment)?;
        self.record(particles, &solved);
        Ok(Outcome::of(&solved))
    }

    /// The motions under loads, with what springs resist, in a fluid that moves at the particles besides.
    fn solved(
        &mut self,
        particles: &mut Particles,
        (loads, (contacts, tethers), ambient): (&Loads, (&[Vec<ContactSprings>], &TetherResistance), &Motion),
        guess: &Guess,
        moment: &Moment,
    ) -> Result<Solved, StepError> {
        let surface = self.forces.surface();
        let resistance =
            moment.implicit.map(|time| move |d: f64, between: Surfaces| surface.resistance(time, d, between));
        let springs = resistance.as_ref().map(|resistance| Springs { resistance, contacts, tethers });
        let (strain_rate, constant_flux) = (self.moving.strain_rate(), self.moving.keeps_flux());
        let acting = Acting { loads, strain_rate, springs: springs.as_ref(), ambient, constant_flux };
        let solved = self.hydrodynamics.solve(self.moving.cell(), particles, &acting, guess);
        let solved = solved.map_err(|source| self.unsolved(source, particles, moment.clock.step()))?;
        if let Some(flux) = self.moving.flux() {
            flux.set_curvature(solved.curvature);
        }
        Ok(solved)
    }

    /// Brings the particles into the box as it is at a moment, and to their ranks. Collective.
    pub fn place(&mut self, particles: &mut Particles, moment: &Moment) -> Result<(), StepError> {
        self.check_positions(particles, &moment.clock)?;
        self.moving.go_to(moment.clock.time_at(moment.fraction), particles);
        self.follow(particles, &moment.clock)?;
        particles.migrate(&self.partition, self.moving.cell());
        Ok(())
    }

    /// A column of velocities less those of the background flow.
    fn relative(&self, particles: &mut Particles, name: &str) -> Vec<Vector> {
        let velocities = particles.vectors(name).to_vec();
        let places = particles.positions.iter().zip(&particles.radii);
        velocities.iter().zip(places).map(|(&v, (&x, &a))| v - self.moving.carried_velocity_of(x, a)).collect()
    }

    /// Adds what velocities are relative to while particles move, so many times.
    fn add_reference(&self, particles: &mut Particles, times: f64) {
        if !self.moving.carries() {
            return;
        }
        let reference: Vec<_> = particles.positions.iter().map(|&x| self.flow().velocity(x) * times).collect();
        particles.vectors(VELOCITY).iter_mut().zip(reference).for_each(|(v, reference)| *v += reference);
    }

    /// Why the flow could not be found at a step. Collective.
    pub(super) fn unsolved(&self, source: SolveError, particles: &mut Particles, step: u64) -> StepError {
        if let SolveError::Interrupted(interrupted) = source {
            return interrupted.into();
        }
        let nothing = [[0.0]; 2];
        let gap = self.approach(particles, [VELOCITY]).after(nothing, [0.0; 2], self.partition.comm()).gap;
        if gap < 0.0 { StepError::Overlap { step, overlap: self.gap(-gap) } } else { StepError::Solve { step, source } }
    }

    /// A length between surfaces, for a message.
    pub(super) fn gap(&self, length: f64) -> Gap {
        Gap { length, radius: self.smallest_radius }
    }

    fn check_positions(&self, particles: &Particles, clock: &Clock) -> Result<(), StepError> {
        let edges = self.cell().edges();
        let is_somewhere = |p: &Vector| (*p / edges).abs().max_element() < FARTHEST;
        let lost = particles.positions.iter().position(|p| !is_somewhere(p));
        let message = |row: usize| {
            format!(
                "step {}: particle {} is at {}, which is no place; the time step is probably too large for the forces \
                 between particles: try a smaller time.step",
                clock.step(),
                particles.ids[row],
                self.axes.place(particles.positions[row])
            )
        };
        self.partition.comm().agree(lost.map_or(Ok(()), |row| Err(message(row)))).map_err(StepError::NotFinite)?;
        self.check_walls(particles, clock)
    }

    /// Refuses spheres whose centres are so near a wall that the flow of their envelopes is none that spheres can have.
    fn check_walls(&self, particles: &Particles, clock: &Clock) -> Result<(), StepError> {
        let sunk = |row: &usize| {
            let walls = self.cell().to_walls(particles.positions[*row]);
            walls.into_iter().any(|to| to.distance < SUNK * particles.radii[*row])
        };
        let message = |row: usize| {
            format!(
                "step {}: particle {} of radius {} was driven into a wall: its centre is at {} = {}; give the scene a \
                 [repulsion], or a larger repulsion.strength, hydrodynamics.lubrication = true, or a smaller time.step",
                clock.step(),
                particles.ids[row],
                Number(particles.radii[row]),
                self.axes.name(2),
                Number(particles.positions[row].z)
            )
        };
        let found = (0..particles.len()).find(sunk).map_or(Ok(()), |row| Err(message(row)));
        self.partition.comm().agree(found).map_err(StepError::IntoWall)
    }

    /// Writes what was solved for into the particles' columns, the background flow included as far as velocities have it while
    /// particles move.
    fn record(&self, particles: &mut Particles, solved: &Solved) {
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

    /// Notes velocities in a column, with what the background flow carries.
    fn note_carried(&self, particles: &mut Particles, column: &str, velocities: &[Vector]) {
        let places = particles.positions.iter().zip(&particles.radii).zip(velocities);
        let carried: Vec<_> = places.map(|((&x, &a), &v)| v + self.moving.carried_velocity_of(x, a)).collect();
        particles.vectors(column).copy_from_slice(&carried);
    }

    /// The relative motion of near pairs, with the velocities of the columns named. Collective.
    pub fn approach<const N: usize>(&self, particles: &mut Particles, columns: [&str; N]) -> RelativeMotion<N> {
        let near = self.watched.find(particles, (self.moving.cell(), &self.partition));
        RelativeMotion::new(near, particles, &self.moving, columns)
    }

    /// From which gap to which lubrication acts, if it does.
    pub fn lubrication(&self) -> Option<Range> {
        self.lubrication
    }

    /// Gaps over the mean radius that smaller ones count as, where what they lose and where their errors are looked at:
    /// with lubrication the closest gap that it knows, and the tolerance; else the range of the repulsion.
    pub fn least_gaps(&self, tolerance: f64) -> [f64; 2] {
        self.lubrication.map_or([self.forces.range(); 2], |range| [range.closest(), tolerance])
    }

    /// The box as it is.
    pub fn cell(&self) -> &PeriodicBox {
        self.moving.cell()
    }

    /// Which rank owns what.
    pub fn partition(&self) -> &Partition {
        &self.partition
    }

    /// Each particle's share of the first moments of repulsion or attraction, or nothing without it. Collective.
    pub fn surface_moments(&self, which: Surface, particles: &Particles) -> Vec<Tensor> {
        self.forces.moments(which, particles, (self.cell(), &self.partition), None)
    }

    /// The shear stress on each wall, see [`crate::Suspension::wall_stress`]. Collective.
    pub fn wall_stress(&self, particles: &Particles, stress: &Tensor) -> Vec<[f64; 2]> {
        let cell = self.cell();
        let mut sums = self.forces.sums_along_walls(particles);
        self.partition.comm().sum(&mut sums);
        let [fx, fy, mx, my] = sums.map(|sum| sum / cell.volume());
        let flow = [self.viscosity * self.moving.rate(), 0.0];
        let height = cell.edges().z;
        let driven =
            self.moving.by_pressure().map_or([0.0; 2], |p| [0.0, height].map(|z| self.viscosity * p.shear_rate(z)));
        let upper = [flow[0] + driven[1] + stress.col(2).x - mx, flow[1] + stress.col(2).y - my];
        let forces = [fx * height + driven[0] - driven[1], fy * height];
        match cell.boundaries() {
            Boundaries::Walls => vec![[upper[0] + forces[0], upper[1] + forces[1]], upper],
            Boundaries::Wall => vec![[flow[0] + forces[0], flow[1] + forces[1]]],
            _ => Vec::new(),
        }
    }

    /// The pressure gradient that keeps the flux, if it is kept.
    pub fn pressure_gradient(&self) -> Option<f64> {
        let flow = self.moving.by_pressure().filter(|_| self.moving.keeps_flux())?;
        Some(self.viscosity * flow.curvature)
    }

    /// What contacts amount to, if there can be any. Collective.
    pub fn measured_contacts(&self, particles: &Particles) -> Option<Measured> {
        self.contacts.as_ref().map(|contacts| contacts.measured(particles, (self.cell(), &self.partition)))
    }

    /// The background flow.
    pub fn flow(&self) -> &BackgroundFlow {
        self.moving.flow()
    }

    /// The largest weight of negative eigenvalues that were left out of random motions so far, over the whole.
    pub fn clipped(&self) -> f64 {
        self.clipped
    }

    /// How the fluid is computed, in words.
    pub fn plan(&mut self) -> String {
        let turn = self.axes.turn();
        self.hydrodynamics.mobility().plan().describe_for(turn)
    }

    /// Evaluations of the mobility since the start.
    pub fn evaluations(&mut self) -> u64 {
        let before = self.following.as_ref().map_or(0, Following::evaluations);
        before + self.hydrodynamics.mobility().work().evaluations
    }

    /// The largest `|k . u| / (|k| |u|)` of any wavevector of the flow that was computed last, if the box repeats along all axes.
    /// Collective.
    pub fn divergence(&mut self) -> Option<f64> {
        let is_periodic = self.cell().boundaries() == Boundaries::Periodic;
        is_periodic.then(|| self.hydrodynamics.mobility().divergence())
    }

    /// The velocity of the fluid relative to the background flow, with the particles as they are. An error where no grid can carry
    /// it. Collective.
    pub fn velocity_field(&mut self, particles: &Particles) -> Result<FluidVelocity, PlanError> {
        let place = (self.moving.cell(), &self.partition);
        let mut loads = self.forces.on(particles, place, None);
        self.tethers.add_known(&mut loads, particles, place);
        applied::add_last(&mut loads, particles);
        let loads = self.warm_start.felt(loads, particles);
        // Whatever the strain: programs that draw a series take all of its frames for as large as the first.
        let plan = self.hydrodynamics.mobility().plan().of_flow(self.moving.largest_strain())?;
        let flow = (self.moving.cell(), self.moving.by_particles());
        Ok(fluid::velocity(&plan, flow, (particles, &loads), self.partition.comm()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, Species, Start};
    use domain::Comm;
    use std::error::Error;

    /// Where no flow is found: because spheres overlap, or for another reason.
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
