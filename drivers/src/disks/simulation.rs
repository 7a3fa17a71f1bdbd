//! A system of disks in motion.

use super::law::Law;
use super::list::List;
use super::motion::Task;
use super::state::State;
use super::{Measurement, Model, Stage, Tally};
use crate::parameter::ParameterError;
use domain::{Particles, PeriodicBox, Random};
use glam::DVec2;

/// A system of disks in motion.
#[derive(Debug, Clone)]
pub struct Disks {
    pub(super) model: Model,
    pub(super) stage: Stage,
    pub(super) law: Law,
    pub(super) step: u64,
    pub(super) state: State,
    pub(super) list: List,
    pub(super) tally: Tally,
}

impl Disks {
    /// The model's disks at random places, overlapping, at rest.
    pub fn random(model: &Model) -> Self {
        let (mut particles, edges) = (Particles::default(), model.cell(0.0).edges());
        for (id, size) in model.sizes().iter().enumerate() {
            let point = Random::new(model.parameters().seed, id as u64).point();
            let place = (point * edges).with_z(0.0);
            particles.push(id as u64, place, size.radius, size.species);
        }
        particles.vectors("velocity");
        Self::given(model, &particles, Stage::Settle).expect("places and velocities are finite")
    }

    /// A random start that has been through settling and mixing, at rest in the flow.
    pub fn prepared(model: &Model) -> Self {
        let mut disks = Self::random(model);
        while disks.stage != Stage::Flow {
            disks.advance(disks.left().unwrap_or(0));
            disks.enter_next_stage();
        }
        disks
    }

    /// The disks of a store in the flow. Without a column `velocity` they move with the liquid.
    pub fn flowing(parameters: super::Parameters, particles: &Particles) -> Result<Self, ParameterError> {
        let model = Model::with_particles(parameters, particles)?;
        Self::given(&model, particles, Stage::Flow)
    }

    fn given(model: &Model, particles: &Particles, stage: Stage) -> Result<Self, ParameterError> {
        let law = model.law(stage);
        let mut state = State::given(particles, &law, model)?;
        state.obey(&law, model);
        Ok(Self::begin(model.clone(), stage, state))
    }

    /// Starts a stage from places and velocities.
    fn begin(model: Model, stage: Stage, mut state: State) -> Self {
        let law = model.law(stage);
        let list = List::make(&mut state, &model, &law, 0, None);
        let mut disks = Self { model, stage, law, step: 0, state, list, tally: Tally::default() };
        let contact = disks.list.push_apart(&mut disks.state, &law, 0, true);
        let motion = disks.state.measure(&law);
        disks.state.start(&law, |radius| disks.model.mass(radius));
        disks.tally = Tally::begin(disks.measurement(&motion, &contact));
        disks
    }

    /// Ends the stage early or in time. The last has no end. When the flow starts, the disks move with the liquid.
    pub fn enter_next_stage(&mut self) {
        let Some(stage) = self.stage.next() else { return };
        let mut state = std::mem::take(&mut self.state);
        let law = self.model.law(stage);
        if stage == Stage::Flow {
            state.wrap(&self.model.cell(0.0), &self.law, 0);
            for body in &mut state.bodies {
                body.velocity = DVec2::new(law.profile.speed(body.place.y), 0.0);
            }
        }
        state.obey(&law, &self.model);
        *self = Self::begin(self.model.clone(), stage, state);
    }

    /// Makes a number of steps of the present stage.
    pub fn advance(&mut self, steps: u64) {
        if steps == 0 {
            return;
        }
        let first = self.step + 1;
        let mut drift = self.state.advance(&self.law, Task::Predict, first - self.list.born, false).drift_squared;
        for left in (0..steps).rev() {
            self.step += 1;
            if self.list.is_stale(&self.law, self.step, drift.sqrt()) {
                self.list = List::make(&mut self.state, &self.model, &self.law, self.step, Some(&self.list));
            }
            let measure = self.step.is_multiple_of(self.model.parameters().measure_every);
            let contact = self.list.push_apart(&mut self.state, &self.law, self.step, measure);
            let task = if left > 0 { Task::Both } else { Task::Correct };
            let motion = self.state.advance(&self.law, task, self.step + 1 - self.list.born, measure);
            drift = motion.drift_squared;
            for (total, begun) in self.tally.collisions.iter_mut().zip(contact.encounters) {
                *total += begun;
            }
            if measure {
                self.tally.add(self.measurement(&motion, &contact));
            }
        }
    }

    fn measurement(&self, motion: &super::sums::MotionSums, contact: &super::sums::ContactSums) -> Measurement {
        let [length, height] = self.model.parameters().edges;
        Measurement::of(self.time(), length * height, self.state.len(), motion, contact)
    }

    /// Starts the count of the tally anew from its latest measurement.
    pub fn restart_tally(&mut self) {
        self.tally = Tally::begin(self.tally.latest);
    }

    /// Lattice periods by which the strain was turned back since the list was made.
    pub(super) fn turns_since_list(&self) -> i32 {
        let [length, height] = self.model.parameters().edges;
        let turns = |step| (self.law.strain(step) * height / length + 0.5).floor() as i32;
        turns(self.step) - turns(self.list.born)
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The present stage.
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// Steps done in the present stage.
    pub fn steps(&self) -> u64 {
        self.step
    }

    /// Steps that the present stage has left, if it has an end.
    pub fn left(&self) -> Option<u64> {
        self.law.steps.map(|steps| steps.saturating_sub(self.step))
    }

    /// Time since the present stage began.
    pub fn time(&self) -> f64 {
        self.law.dt * self.step as f64
    }

    /// Rate of shear times that time.
    pub fn strain(&self) -> f64 {
        self.model.parameters().flow.rate(self.model.parameters().edges[1]) * self.time()
    }

    /// The lattice of images now.
    pub fn cell(&self) -> PeriodicBox {
        self.model.cell(self.law.strain(self.step))
    }

    /// What was counted since the stage began or the count was restarted.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }
}
