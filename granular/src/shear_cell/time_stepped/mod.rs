//! The paper's engine: grains fly for a fixed step, then every overlapping and approaching pair collides.

mod neighbours;

use super::{
    CellModel, CellState, CellTally, CollisionDetection, CollisionEngine, GrainMotion, Grains, Rebound, Side, Top,
    TopWall, grains::wrap,
};
use crate::parameter::{ParameterError, positive, refused};
use domain::{Number, Vector};
use neighbours::GrainPairs;

/// Number of grains times steps between two checks whether to continue: a fraction of a second.
const CHECK_INTERVAL: u64 = 5_000_000;

/// Displacement of the fastest grain in a step, over the diameter, at which loads up to a million times the weight of
/// a layer of grains were found to be carried.
const SAFE_DISPLACEMENT: f64 = 0.0025;

/// The time-stepped engine. Each step: `v += a dt`, `x += v dt`; then the collision rule for every wall that a grain
/// penetrates and approaches; then that for every pair that overlaps and approaches, in a fixed order.
pub struct TimeStepped {
    model: CellModel,
    step: f64,
    /// Not wrapped between two searches for neighbours.
    grains: Grains,
    top_wall: TopWall,
    near: GrainPairs,
    tally: CellTally,
    /// Speed of the fastest grain at the start.
    fastest: f64,
    /// Whether a grain has passed through a wall, or the top wall has reached the bottom.
    escaped: bool,
}

impl TimeStepped {
    /// Starts from grains inside the cell.
    pub fn new(model: &CellModel, state: &CellState, step: f64) -> Result<Self, ParameterError> {
        positive("time.collision_step", step)?;
        state.check(model)?;
        let mut engine = Self {
            model: *model,
            step,
            grains: state.grains.clone(),
            top_wall: state.top_wall,
            near: GrainPairs::default(),
            tally: state.tally,
            fastest: state.grains.motions.iter().map(|m| m.velocity.length()).fold(0.0, f64::max),
            escaped: false,
        };
        engine.near.search(model, &mut engine.grains, engine.top_wall.height);
        Ok(engine)
    }

    /// The reason why grains escape, and a step that would do: at most a tenth of the present step, and one in which
    /// nothing moves by more than `SAFE_DISPLACEMENT` diameters, at the speed of the walls plus that to which gravity
    /// and the load can accelerate the top wall, `sqrt(2 (g + P/M) H)`.
    fn too_long(&self) -> ParameterError {
        let p = self.model.parameters();
        let fall = (2.0 * (p.gravity + self.model.top_wall_acceleration()) * p.height).sqrt();
        let enough = (SAFE_DISPLACEMENT * p.diameter / (p.speed + self.fastest + fall)).min(0.1 * self.step);
        let load = match p.top {
            Top::Free { pressure, .. } => format!(" under top.pressure = {}, or a lower pressure", Number(pressure)),
            Top::Fixed => String::new(),
        };
        let allowed = format!(
            "at most about {:.2}{load}: at time {:.4} grains were pushed through a wall or each other",
            Number(enough),
            Number(self.tally.time)
        );
        refused("time.collision_step", Number(self.step), allowed)
    }

    fn take_step(&mut self) {
        self.drift();
        self.lower_top_wall();
        self.strike_walls();
        if self.escaped {
            return;
        }
        self.near.refresh(&self.model, &mut self.grains, self.top_wall.height);
        self.strike_pairs();
        self.tally.time += self.step;
    }

    fn drift(&mut self) {
        let (dt, reference) = (self.step, self.near.reference);
        let (mut impulse, mut work, mut fastest) = (Vector::ZERO, 0.0, 0.0);
        let Grains { positions, motions } = &mut self.grains;
        for (x, GrainMotion { velocity: v, .. }) in positions.iter_mut().zip(motions) {
            let kick = self.model.acceleration(*x, *v) * dt;
            work += kick.dot(*v + kick * 0.5);
            impulse += kick;
            *v += kick;
            *x += *v * dt;
            fastest = f64::max(fastest, (*v - reference).length_squared());
        }
        let mass = self.model.mass();
        self.tally.body_impulse += impulse * mass;
        self.tally.body_work += work * mass;
        self.near.moved(fastest.sqrt() * dt);
    }

    fn lower_top_wall(&mut self) {
        let kick = -self.model.top_wall_acceleration() * self.step;
        self.tally.load_work +=
            self.model.top_wall_mass().unwrap_or(0.0) * kick * (self.top_wall.velocity + 0.5 * kick);
        self.top_wall.velocity += kick;
        self.top_wall.height += self.top_wall.velocity * self.step;
        self.escaped |= self.top_wall.height <= self.model.parameters().diameter;
    }

    fn strike_walls(&mut self) {
        if self.model.sides().is_empty() {
            return;
        }
        let radius = self.model.radius();
        let (top, inner) = (self.top_wall.height - radius, self.model.edges().z - radius);
        for i in 0..self.grains.len() {
            let x = self.grains.positions[i];
            if x.y < radius || x.y > top || x.z < radius || x.z > inner {
                for side in Side::ALL {
                    self.strike_wall(i, side);
                }
            }
        }
    }

    fn strike_wall(&mut self, i: usize, side: Side) {
        let (model, radius) = (&self.model, self.model.radius());
        let wall = model.wall_contact(side, self.top_wall.velocity);
        let (x, motion, normal) = (self.grains.positions[i], &mut self.grains.motions[i], side.normal());
        let plane = match side {
            Side::Bottom | Side::Outer => 0.0,
            Side::Top => self.top_wall.height,
            Side::Inner => model.edges().z,
        };
        let overlap = radius - (x[side.axis()] - plane) * normal[side.axis()];
        self.escaped |= overlap > model.parameters().diameter;
        if overlap <= 0.0 || (motion.velocity - wall.velocity).dot(normal) >= 0.0 {
            return;
        }
        let before = motion.energy(radius);
        let impulse = model.parameters().wall_contact.strike_wall(motion, &wall, radius, Rebound::default());
        let gain = motion.energy(radius) - before;
        self.tally.strike_wall(model, &wall, impulse, gain, &mut self.top_wall);
        self.tally.largest_overlap = self.tally.largest_overlap.max(overlap / model.parameters().diameter);
    }

    fn strike_pairs(&mut self) {
        let (model, radius, diameter) = (&self.model, self.model.radius(), self.model.parameters().diameter);
        let rule = model.parameters().grain_contact;
        let (mut lost, mut collisions, mut overlaps, mut deepest) = (0.0, 0, 0.0, self.tally.largest_overlap);
        let Grains { positions, motions } = &mut self.grains;
        let mut strike = |i: usize, j: usize, d: Vector, motions: &mut [GrainMotion]| {
            let [a, b] = motions.get_disjoint_mut([i, j]).expect("a pair is of two grains");
            let (distance, before) = (d.length(), a.energy(radius) + b.energy(radius));
            rule.strike_pair([&mut *a, &mut *b], d / distance, radius, Rebound::default());
            let overlap = 1.0 - distance / diameter;
            lost += before - a.energy(radius) - b.energy(radius);
            collisions += 1;
            overlaps += overlap;
            deepest = f64::max(deepest, overlap);
        };
        for &(i, j) in &self.near.within {
            let (i, j) = (i as usize, j as usize);
            let d = positions[j] - positions[i];
            if d.length_squared() < diameter * diameter && d.dot(motions[j].velocity - motions[i].velocity) < 0.0 {
                strike(i, j, d, motions);
            }
        }
        for &(i, j, shift) in &self.near.across {
            let (i, j) = (i as usize, j as usize);
            let d = positions[j] + shift - positions[i];
            if d.length_squared() < diameter * diameter && d.dot(motions[j].velocity - motions[i].velocity) < 0.0 {
                strike(i, j, d, motions);
            }
        }
        self.tally.dissipated += lost * model.mass();
        self.tally.pair_collisions += collisions;
        self.tally.overlaps += overlaps;
        self.tally.largest_overlap = deepest;
    }
}

impl CollisionEngine for TimeStepped {
    fn collisions(&self) -> CollisionDetection {
        CollisionDetection::TimeStepped { step: self.step }
    }

    fn advance(&mut self, duration: f64, may_continue: &dyn Fn() -> bool) -> bool {
        let steps = (duration / self.step).round() as u64;
        let look = (CHECK_INTERVAL / self.grains.len().max(1) as u64).max(1);
        for step in 1..=steps {
            self.take_step();
            if self.escaped || (step.is_multiple_of(look) && step < steps && !may_continue()) {
                return false;
            }
        }
        true
    }

    fn failure(&self) -> Option<ParameterError> {
        self.escaped.then(|| self.too_long())
    }

    fn cause(&self, _error: ParameterError) -> ParameterError {
        self.too_long()
    }

    fn grains(&self) -> Grains {
        let mut grains = self.grains.clone();
        wrap(&self.model, &mut grains.positions);
        grains
    }

    fn tally(&self) -> &CellTally {
        &self.tally
    }

    fn top_wall(&self) -> TopWall {
        self.top_wall
    }
}
