//! A system of disks and its time stepping.

use super::motion::PassTask;
use super::stage::Law;
use super::state::DiskState;
use super::verlet_list::List;
use super::{DiskModel, DiskTally, Measurement, Stage};
use crate::parameter::{ParameterError, refused, require};
use domain::{Number, Particles, PeriodicBox, Random};
use glam::DVec2;
use simulation::Clock;

/// A system of disks in motion.
#[derive(Debug, Clone)]
pub struct Disks {
    pub(super) model: DiskModel,
    pub(super) stage: Stage,
    pub(super) law: Law,
    pub(super) clock: Clock,
    pub(super) state: DiskState,
    pub(super) list: List,
    pub(super) tally: DiskTally,
    /// Whether a disk has moved relative to the liquid by more than half the cell between two checks.
    pub(super) escaped: bool,
}

/// Largest number of disks times steps in one call, so that requests to stop are noticed soon.
const MOMENT: u64 = 1_000_000;

impl Disks {
    /// The model's disks at random positions, overlapping, at rest.
    pub fn random(model: &DiskModel) -> Self {
        let (edges, seed) = (model.cell(0.0).edges(), model.parameters().seed);
        let positions = (0..model.sizes().len() as u64).map(|id| (Random::new(seed, id).point() * edges).with_z(0.0));
        let (radii, species) = model.sizes().iter().map(|size| (size.radius, size.species)).unzip();
        let mut particles = Particles::numbered(positions.collect(), radii, species);
        particles.vectors("velocity");
        Self::given(model, &particles, Stage::RemoveOverlaps, 0).expect("positions and velocities are finite")
    }

    /// A random start after the stages of preparation, at rest relative to the liquid.
    pub fn prepared(model: &DiskModel) -> Result<Self, ParameterError> {
        Self::prepare_with_progress(model, &mut |_| {})
    }

    /// Like [`Disks::prepared`]; `tell` is called from time to time with the completed fraction of the steps.
    pub fn prepare_with_progress(model: &DiskModel, tell: &mut dyn FnMut(f64)) -> Result<Self, ParameterError> {
        let mut disks = Self::random(model);
        let all = model.preparing_steps();
        let mut done = 0;
        while let Some(left) = disks.left() {
            if left == 0 {
                disks.enter_next_stage();
                continue;
            }
            let steps = left.min(disks.moment());
            disks.advance(steps);
            disks.check()?;
            done += steps;
            tell(done as f64 / all as f64);
        }
        Ok(disks)
    }

    /// Number of steps in one call.
    pub(super) fn moment(&self) -> u64 {
        (MOMENT / self.state.len() as u64).max(1)
    }

    /// Refuses disks that have flown off, as happens where the contacts are unstable.
    pub fn check(&self) -> Result<(), ParameterError> {
        let key = if self.stage == Stage::Flow { "time.step" } else { "preparation.time_step" };
        let allowed = format!(
            "to be shorter, an integrator that is stable (\"gear-four\"), or a start without deep overlaps: disks flew \
             off at step {}",
            self.clock.step()
        );
        require(!self.escaped, key, Number(self.law.dt), allowed)
    }

    /// Disks of a particle store, in the stage with flow. Without a column `velocity` they move with the liquid.
    pub fn flowing(parameters: super::DiskParameters, particles: &Particles) -> Result<Self, ParameterError> {
        let model = DiskModel::with_particles(parameters, particles)?;
        check_positions(&model, model.parameters().strain, particles)?;
        Self::given(&model, particles, Stage::Flow, 0)
    }

    fn given(model: &DiskModel, particles: &Particles, stage: Stage, step: u64) -> Result<Self, ParameterError> {
        let law = model.law(stage);
        let mut state = DiskState::given(particles, &law, model)?;
        state.set_response(&law, model);
        Ok(Self::begin(model.clone(), stage, step, state))
    }

    /// The same disks at the same step, with the positions and velocities of a store, as if they had just begun to
    /// move: counts start afresh.
    pub fn rearranged(&self, particles: &Particles) -> Result<Self, ParameterError> {
        check_positions(&self.model, self.law.strain(self.clock.step()), particles)?;
        Self::given(&self.model, particles, self.stage, self.clock.step())
    }

    /// Starts a stage, or continues it after some steps, from positions and velocities.
    fn begin(model: DiskModel, stage: Stage, step: u64, mut state: DiskState) -> Self {
        let law = model.law(stage);
        let list = List::build(&mut state, &model, &law, step, None);
        let (clock, tally) = (Clock::at(step, law.dt), DiskTally::default());
        let mut disks = Self { model, stage, law, clock, state, list, tally, escaped: false };
        let contact = disks.list.add_contact_forces(&mut disks.state, &law, step, true);
        let motion = disks.state.advance(&law, PassTask::Measure, 0, true);
        disks.state.start(&law, |radius| disks.model.mass(radius));
        disks.tally = DiskTally::begin(disks.measurement(&motion, &contact));
        disks
    }

    /// Ends the present stage, early or at its end, and starts the next; the last stage has no end. When the flow
    /// starts, the disks move with the liquid.
    pub fn enter_next_stage(&mut self) {
        let Some(stage) = self.stage.next() else { return };
        let mut state = std::mem::take(&mut self.state);
        let law = self.model.law(stage);
        if stage == Stage::Flow {
            state.wrap(&self.model.cell(0.0), &self.law, 0);
            for body in &mut state.bodies {
                body.velocity = DVec2::new(law.profile.speed(body.position.y), 0.0);
            }
        }
        state.set_response(&law, &self.model);
        *self = Self::begin(self.model.clone(), stage, 0, state);
    }

    /// Takes a number of steps of the present stage.
    pub fn advance(&mut self, steps: u64) {
        if steps == 0 {
            return;
        }
        let [length, height] = self.model.parameters().edges;
        let (first, farthest) = (self.clock.step() + 1, 0.25 * length.min(height).powi(2));
        let mut drift =
            self.state.advance(&self.law, PassTask::Predict, first - self.list.built_at_step, false).drift_squared;
        for left in (0..steps).rev() {
            self.clock.tick();
            let step = self.clock.step();
            if drift > farthest {
                self.escaped = true;
                return;
            }
            if self.list.is_stale(&self.law, step, drift.sqrt()) {
                self.list = List::build(&mut self.state, &self.model, &self.law, step, Some(&self.list));
            }
            let measure = step.is_multiple_of(self.model.parameters().measure_every);
            let contact = self.list.add_contact_forces(&mut self.state, &self.law, step, measure);
            let task = if left > 0 { PassTask::Both } else { PassTask::Correct };
            let motion = self.state.advance(&self.law, task, step + 1 - self.list.built_at_step, measure);
            drift = motion.drift_squared;
            self.tally.collisions += contact.encounters;
            if measure {
                self.escaped |= !motion.terms[0].is_finite();
                self.tally.add(self.measurement(&motion, &contact));
            }
        }
    }

    fn measurement(&self, motion: &super::sums::MotionSums, contact: &super::sums::ContactSums) -> Measurement {
        let [length, height] = self.model.parameters().edges;
        Measurement::of(self.clock.time(), length * height, self.state.len(), motion, contact)
    }

    /// Restarts the tally at its latest measurement.
    pub fn restart_tally(&mut self) {
        self.tally = DiskTally::begin(self.tally.latest);
    }

    /// Number of lattice periods by which the strain was reduced since the list was built.
    pub(super) fn lattice_shifts_since_list(&self) -> i32 {
        self.law.lattice_shifts(&self.model, self.list.built_at_step..self.clock.step())
    }

    /// The model.
    pub fn model(&self) -> &DiskModel {
        &self.model
    }

    /// The present stage.
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// Steps and time since the present stage began.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Steps left in the present stage, if it has an end.
    pub fn left(&self) -> Option<u64> {
        self.law.steps.map(|steps| steps.saturating_sub(self.clock.step()))
    }

    /// Shear rate times that time.
    pub fn strain(&self) -> f64 {
        self.model.parameters().flow.rate(self.model.parameters().edges[1]) * self.clock.time()
    }

    /// The lattice of images at the present time.
    pub fn cell(&self) -> PeriodicBox {
        self.model.cell(self.law.strain(self.clock.step()))
    }

    /// Sums over time since the stage began or the tally was restarted.
    pub fn tally(&self) -> &DiskTally {
        &self.tally
    }
}

/// Two disks at one point exert no force on each other.
fn check_positions(model: &DiskModel, strain: f64, particles: &Particles) -> Result<(), ParameterError> {
    let cell = model.cell(strain);
    let mut positions: Vec<DVec2> = particles.positions.iter().map(|&x| cell.wrap(x).0.truncate()).collect();
    positions.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let twins = positions.windows(2).find(|pair| pair[0] == pair[1]);
    twins.map_or(Ok(()), |pair| {
        let found = format_args!("{} of two disks", pair[0]);
        Err(refused("particles.position", found, "a place of its own for each"))
    })
}
