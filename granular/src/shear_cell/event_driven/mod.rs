//! The event-driven engine: grains fly freely between collisions, and every collision happens at its exact time.
//!
//! Each grain keeps one plan: its next contact and its next exit from its cell. A plan that is void because the
//! partner collided with another grain first is noticed at its time, and the grain plans again; the partner's next
//! event is in the partner's plan. Gravity is common to all grains and drops out of their relative motion. The
//! acceleration in a curved trough differs from grain to grain: each keeps the value at its last collision, renewed
//! after a short time, and the squared distance of two grains is an exact quartic in time.
//!
//! Two collisions of a grain within the contact time count as one: the second is elastic (Luding and `McNamara`
//! 1998). A grain that its acceleration presses onto another or a wall rebounds fast enough to stay away for the
//! contact time. Both keep the number of events in any time finite.

mod cells;
mod collisions;
mod contact_time;
mod flights;
mod grain;
mod plan;
mod queue;
mod top_wall;

use super::{CellModel, CellState, CellTally, CollisionDetection, CollisionEngine, GrainMotion, Grains, TopWall};
use crate::parameter::{ParameterError, require};
use bytemuck::Zeroable as _;
use cells::{GrainCells, NEAR, NearGrains};
pub(super) use contact_time::GrowingDiameter;
use contact_time::RelativeFlight;
use domain::{Bytes, Number, Vector};
use flights::Flights;
use grain::{Exit, Grain, NextEvent, Rotation};
use queue::Queue;

/// Displacement, over the diameter, that the relative acceleration of two grains may cause before it is renewed.
const DRIFT_TOLERANCE: f64 = 0.01;
/// Events per grain between two times at which all grains are advanced to the same time.
const EVENTS_PER_GRAIN: u64 = 16;

/// Number of collisions, or events, between two checks whether to continue: a fraction of a second.
const CHECK_INTERVAL: u64 = 200_000;

const NO_GRAIN: u32 = u32::MAX;

/// The event-driven engine.
pub struct EventDriven {
    model: CellModel,
    /// Id of the grain in each row: grains close to each other in the cell are close to each other in memory.
    ids: Vec<usize>,
    grains: Vec<Grain>,
    accelerations: Vec<Vector>,
    rotations: Vec<Rotation>,
    plans: Vec<NextEvent>,
    /// One entry per grain, and the last for the top wall.
    queue: Queue,
    cells: GrainCells,
    near: Box<NearGrains>,
    flights: Box<Flights>,
    /// Buffer for the nearby grains on curved trajectories that a grain may meet.
    curved_flights: Vec<(u32, RelativeFlight)>,
    /// Time since the grains were last advanced together, the origin of time of plans and grains.
    now: f64,
    /// Diameter at that time; it grows in packing only.
    size: GrowingDiameter,
    /// Time for which a stored acceleration is valid.
    horizon: f64,
    accelerated: bool,
    top_wall: top_wall::MovingWall,
    tally: CellTally,
    events: Events,
    jammed: bool,
}

/// Predicted memory of the engine with `count` grains: about one cell per grain, and a tree of times as the queue.
pub fn bytes(model: &CellModel, count: f64) -> Bytes {
    let (queue, cells) = (Bytes::list::<f64>(8.0 / 7.0 * count), Bytes::keep(GrainCells::bytes(model, count)));
    Bytes::list::<(usize, Grain, Vector, Rotation, NextEvent)>(count).then(queue).then(cells)
}

/// Numbers of events.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Events {
    /// Collisions between grains and with walls.
    pub collisions: u64,
    /// Transitions between cells.
    pub passages: u64,
    /// Plans made again because the partner had collided first, or because the stored acceleration had expired.
    pub renewals: u64,
}

impl EventDriven {
    /// Starts from grains inside the cell that overlap by round-off at most.
    pub fn new(model: &CellModel, state: &CellState) -> Result<Self, ParameterError> {
        state.check(model)?;
        let deepest = state.grains.deepest_overlap(model);
        let apart = "grains apart: the event-driven engine can't start from overlaps";
        require(deepest < 1e-9, "overlap", format_args!("{deepest:.2e} diameters"), apart)?;
        let (contact, horizon) = (model.parameters().contact_time, horizon(model));
        let longest = format_args!(
            "at most {:.3}: in a longer time gravity, the curved path or the load of the top move a grain by a \
             hundredth of its diameter; take a shorter one, or less of those",
            Number(horizon)
        );
        require(contact <= horizon, "grains.contact_time", Number(contact), longest)?;
        Ok(Self::growing(model, state, GrowingDiameter { diameter: model.parameters().diameter, growth: 0.0 }))
    }

    /// Like [`EventDriven::new`], with a diameter that grows to the model's.
    pub(super) fn growing(model: &CellModel, state: &CellState, size: GrowingDiameter) -> Self {
        let accelerated = model.has_body_force();
        let cells = GrainCells::fitting(model, state.top_wall.height, state.grains.len());
        let Grains { positions, motions } = &state.grains;
        let mut ids: Vec<usize> = (0..positions.len()).collect();
        ids.sort_by_key(|&id| cells.at(positions[id]));
        let fly = |&id: &usize| Grain { position: positions[id], velocity: motions[id].velocity, ..Grain::default() };
        let grains: Vec<Grain> = ids.iter().map(fly).collect();
        let turn = |&id: &usize| Rotation { spin: motions[id].spin, last_collision: f64::NEG_INFINITY };
        let pull = |g: &Grain| if accelerated { model.acceleration(g.position, g.velocity) } else { Vector::ZERO };
        let mut engine = Self {
            model: *model,
            accelerations: grains.iter().map(pull).collect(),
            rotations: ids.iter().map(turn).collect(),
            plans: vec![NextEvent::default(); ids.len()],
            queue: Queue::new(ids.len() + 1),
            ids,
            grains,
            cells,
            near: Box::new(NearGrains::zeroed()),
            flights: Box::new(Flights::zeroed()),
            curved_flights: vec![(NO_GRAIN, RelativeFlight::default()); NEAR],
            now: 0.0,
            size,
            horizon: horizon(model),
            accelerated,
            top_wall: top_wall::MovingWall::new(state.top_wall, -model.top_wall_acceleration()),
            tally: state.tally,
            events: Events::default(),
            jammed: false,
        };
        engine.sort_and_plan();
        engine
    }

    /// Runs until `collisions` more collisions have happened; stops early if no event is left.
    pub fn advance_collisions(&mut self, collisions: u64) {
        self.run(f64::INFINITY, collisions, &|| true);
    }

    /// Runs for a time or a number of collisions, whichever ends first, while `may_continue` returns
    /// true. Returns the time left.
    pub(super) fn run(&mut self, duration: f64, collisions: u64, may_continue: &dyn Fn() -> bool) -> f64 {
        let (enough, mut look) =
            (self.events.collisions.saturating_add(collisions), self.events.total() + CHECK_INTERVAL);
        let mut left = duration;
        loop {
            let lap = self.events.total() + EVENTS_PER_GRAIN * self.grains.len() as u64;
            let limit = f64::min(left, f64::MAX);
            let mut next = self.queue.earliest();
            while next.1 <= limit && self.events.collisions < enough && self.events.total() < lap {
                self.process_event(next.0, next.1);
                next = self.queue.earliest();
            }
            let (idle, enough) = (next.1 > limit, self.events.collisions >= enough);
            if idle && left.is_finite() {
                self.now = f64::max(self.now, left);
            }
            left -= self.now;
            self.advance_all();
            if idle || enough {
                return if idle { 0.0 } else { left };
            }
            // There may be many other events per collision.
            if self.events.total() >= look {
                look = self.events.total() + CHECK_INTERVAL;
                if !may_continue() {
                    return left;
                }
            }
        }
    }

    /// Numbers of events so far.
    pub fn events(&self) -> Events {
        self.events
    }

    pub(super) fn diameter(&self) -> f64 {
        self.size.diameter + self.size.growth * self.now
    }

    /// Multiplies all velocities, and plans again.
    pub(super) fn scale_velocities(&mut self, factor: f64) {
        for grain in &mut self.grains {
            grain.velocity *= factor;
        }
        self.sort_and_plan();
    }

    fn process_event(&mut self, i: usize, time: f64) {
        self.now = f64::max(self.now, time);
        if i == self.grains.len() {
            return self.top_wall_event();
        }
        let plan = self.plans[i];
        if plan.contact <= plan.exit {
            let j = plan.partner as usize;
            if self.grains[j].stamp == plan.stamp { self.pair_event(i, j) } else { self.plan_again(i) }
        } else {
            match plan.exit_by {
                Exit::Renewal => {
                    self.advance_grain(i);
                    self.change_path(i);
                    self.plan_again(i);
                }
                Exit::Face { axis, up } => self.face_event(i, axis as usize, up),
            }
        }
    }

    fn advance_grain(&mut self, i: usize) {
        let pull = self.accelerated.then_some(self.accelerations[i]);
        let grain = &mut self.grains[i];
        let (position, velocity) = grain.at(self.now, pull);
        if let Some(pull) = pull {
            let mass = self.model.mass();
            self.tally.body_work += mass * pull.dot(position - grain.position);
            self.tally.body_impulse += (velocity - grain.velocity) * mass;
        }
        (grain.position, grain.velocity, grain.time) = (position, velocity, self.now);
    }

    fn motion(&self, i: usize) -> GrainMotion {
        GrainMotion { velocity: self.grains[i].velocity, spin: self.rotations[i].spin }
    }

    fn set_motion(&mut self, i: usize, motion: GrainMotion) {
        (self.grains[i].velocity, self.rotations[i].spin) = (motion.velocity, motion.spin);
    }

    /// Plans the next event of a grain whose trajectory is unchanged.
    fn plan_again(&mut self, i: usize) {
        self.events.renewals += 1;
        self.advance_grain(i);
        self.plan(i);
    }

    fn change_path(&mut self, i: usize) {
        let grain = &mut self.grains[i];
        grain.stamp = grain.stamp.wrapping_add(1);
        if self.accelerated {
            self.accelerations[i] = self.model.acceleration(grain.position, grain.velocity);
        }
    }

    /// Advances everything to the present time and makes it the origin of time, so that times stay exact.
    fn advance_all(&mut self) {
        self.add_load_work();
        for i in 0..self.grains.len() {
            self.advance_grain(i);
            self.grains[i].time = 0.0;
            self.rotations[i].last_collision -= self.now;
            let plan = &mut self.plans[i];
            for time in [&mut plan.contact, &mut plan.exit, &mut plan.renewal] {
                *time -= self.now;
            }
        }
        self.top_wall.rebase(self.now);
        self.queue.rebase(self.now);
        self.tally.time += self.now;
        self.size.diameter = self.diameter();
        self.now = 0.0;
    }

    /// Sorts all grains, at the same time, into cells that fit the present box, and plans all events.
    fn sort_and_plan(&mut self) {
        self.cells = GrainCells::fitting(&self.model, self.top_wall().height, self.grains.len());
        for i in 0..self.grains.len() {
            let cell = self.cells.at(self.grains[i].position);
            self.cells.enter(i as u32, cell);
            self.grains[i].cell = cell;
        }
        (0..self.grains.len()).for_each(|i| self.plan(i));
        self.plan_top_wall();
    }
}

impl CollisionEngine for EventDriven {
    fn collisions(&self) -> CollisionDetection {
        CollisionDetection::EventDriven
    }

    fn advance(&mut self, duration: f64, may_continue: &dyn Fn() -> bool) -> bool {
        let mut left = duration;
        while !self.jammed {
            let before = self.tally.time;
            left = self.run(left, CHECK_INTERVAL, may_continue);
            if left == 0.0 {
                return true;
            }
            if !may_continue() {
                return false;
            }
            // A collision involves two grains.
            let pause = (self.tally.time - before) * self.grains.len() as f64 / (2 * CHECK_INTERVAL) as f64;
            self.jammed = pause < self.model.parameters().contact_time;
        }
        false
    }

    /// They count as jammed when the mean time between a grain's collisions is less than the contact time.
    fn is_jammed(&self) -> bool {
        self.jammed
    }

    fn grains(&self) -> Grains {
        let count = self.grains.len();
        let mut grains = Grains { positions: vec![Vector::ZERO; count], motions: vec![GrainMotion::default(); count] };
        for (row, &id) in self.ids.iter().enumerate() {
            (grains.positions[id], grains.motions[id]) = (self.grains[row].position, self.motion(row));
        }
        super::grains::wrap(&self.model, &mut grains.positions);
        grains
    }

    fn tally(&self) -> &CellTally {
        &self.tally
    }

    fn top_wall(&self) -> TopWall {
        self.top_wall.at(self.now)
    }
}

/// Time for which a stored acceleration is valid.
fn horizon(model: &CellModel) -> f64 {
    let turned = 2.0 * DRIFT_TOLERANCE * model.parameters().diameter;
    if model.has_body_force() { (turned / model.acceleration_bound()).sqrt() } else { f64::INFINITY }
}

impl Events {
    /// Number of events of all kinds.
    pub fn total(&self) -> u64 {
        self.collisions + self.passages + self.renewals
    }
}
