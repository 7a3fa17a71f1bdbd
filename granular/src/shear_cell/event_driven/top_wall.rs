//! The free top wall. It has one entry in the event queue: its next collision, or the time up to which none was
//! found. Its collisions are predicted with the grains in the top layer of cells.

use super::super::{Side, TopWall};
use super::{EventDriven, NO_GRAIN, contact_time::time_to_plane};

/// The moving top wall and its next collision.
pub struct MovingWall {
    start: TopWall,
    /// Time of the state `start`.
    since: f64,
    acceleration: f64,
    next: f64,
    grain: u32,
    stamp: u32,
}

/// Range of the wall's position, in layers of cells, outside of which the cells are rebuilt.
const LOWEST: f64 = 0.25;
const HIGHEST: f64 = 2.25;

impl MovingWall {
    pub fn new(start: TopWall, acceleration: f64) -> Self {
        Self { start, since: 0.0, acceleration, next: f64::INFINITY, grain: NO_GRAIN, stamp: 0 }
    }

    pub fn is_free(&self) -> bool {
        self.acceleration < 0.0
    }

    pub fn at(&self, time: f64) -> TopWall {
        let t = time - self.since;
        TopWall {
            height: self.start.height + (self.start.velocity + 0.5 * self.acceleration * t) * t,
            velocity: self.start.velocity + self.acceleration * t,
        }
    }

    pub fn set(&mut self, top_wall: TopWall, time: f64) {
        (self.start, self.since) = (top_wall, time);
    }

    pub fn rebase(&mut self, origin: f64) {
        self.since -= origin;
        self.next -= origin;
    }
}

impl EventDriven {
    /// Event of the wall: a collision, a planned collision that is void as the grain's trajectory
    /// has changed, or a renewal.
    pub(super) fn top_wall_event(&mut self) {
        self.add_load_work();
        let MovingWall { grain, stamp, .. } = self.top_wall;
        if grain != NO_GRAIN && self.grains[grain as usize].stamp == stamp {
            self.advance_grain(grain as usize);
            self.wall_event(grain as usize, Side::Top);
        } else {
            self.events.renewals += 1;
        }
        self.plan_top_wall();
    }

    /// Plans the wall's next collision with the grains in the top layer; rebuilds the cells if
    /// the wall has left its range.
    pub(super) fn plan_top_wall(&mut self) {
        if !self.top_wall.is_free() {
            return;
        }
        let layers = self.cells.counts[1] - 1;
        let above = self.top_wall.at(self.now).height - 0.5 * self.diameter() - layers as f64 * self.cells.edges.y;
        let misplaced = (layers > 0 && above < LOWEST * self.cells.edges.y) || above > HIGHEST * self.cells.edges.y;
        if misplaced {
            self.advance_all();
            return self.sort_and_plan();
        }
        (self.top_wall.next, self.top_wall.grain) = (self.now + self.horizon, NO_GRAIN);
        for z in 0..self.cells.counts[2] {
            for x in 0..self.cells.counts[0] {
                let cell = self.cells.index([x, layers, z]);
                for k in 0..self.cells.grains(cell).len() {
                    self.offer_top_wall(self.cells.grains(cell)[k] as usize);
                }
            }
        }
        self.queue.set(self.grains.len(), self.top_wall.next);
    }

    /// Updates the wall's plan for a grain's new trajectory.
    pub(super) fn plan_top_wall_collision(&mut self, i: usize) {
        if self.top_wall.is_free() && self.cells.coordinates(self.grains[i].cell)[1] + 1 == self.cells.counts[1] {
            self.offer_top_wall(i);
            self.queue.set(self.grains.len(), self.top_wall.next);
        }
    }

    fn offer_top_wall(&mut self, i: usize) {
        let (top_wall, grain) = (self.top_wall.at(self.now), &self.grains[i]);
        let fall = self.accelerations[i];
        let (position, velocity) = grain.at(self.now, Some(fall));
        let gap = top_wall.height - 0.5 * self.diameter() - position.y;
        let time = self.now + time_to_plane(gap, velocity.y - top_wall.velocity, fall.y - self.top_wall.acceleration);
        if time < self.top_wall.next {
            (self.top_wall.next, self.top_wall.grain, self.top_wall.stamp) = (time, i as u32, grain.stamp);
        }
    }

    /// Adds the work of the load since the wall was last updated, and updates the wall to the present time.
    pub(super) fn add_load_work(&mut self) {
        let top_wall = self.top_wall.at(self.now);
        let fallen = self.top_wall.start.height - top_wall.height;
        self.tally.load_work += self.model.top_wall_mass().unwrap_or(0.0) * self.model.top_wall_acceleration() * fallen;
        self.top_wall.set(top_wall, self.now);
    }
}
