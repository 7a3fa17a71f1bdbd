//! Prediction of a grain's next event.

use super::{
    EventDriven, NO_GRAIN,
    contact_time::{GrowingDiameter, RelativeFlight, curved_contact_time, time_to_plane},
    flights::FlightInput,
    grain::{Exit, NextEvent},
};

impl EventDriven {
    /// Predicts the next event of a grain that has been updated to the present time.
    pub(super) fn plan(&mut self, i: usize) {
        let renewal = self.now + self.horizon;
        let (exit, exit_by) = self.exit(i, renewal);
        self.plans[i] = NextEvent { contact: f64::INFINITY, partner: NO_GRAIN, stamp: 0, renewal, exit, exit_by };
        self.plan_contacts(i, [[-1, 1]; 3]);
        self.plan_top_wall_collision(i);
    }

    /// Predicts the next event of a grain that has just entered its cell: keeps the planned contact, and considers
    /// the layer of cells that are new neighbours.
    pub(super) fn plan_after_passage(&mut self, i: usize, axis: usize, up: bool) {
        let (exit, exit_by) = self.exit(i, self.plans[i].renewal);
        let plan = &mut self.plans[i];
        (plan.exit, plan.exit_by) = (exit, exit_by);
        let mut reach = [[-1, 1]; 3];
        reach[axis] = if up { [1, 1] } else { [-1, -1] };
        self.plan_contacts(i, reach);
        self.plan_top_wall_collision(i);
    }

    fn plan_contacts(&mut self, i: usize, reach: [[isize; 2]; 3]) {
        let best = if self.accelerated { self.contact::<true>(i, reach) } else { self.contact::<false>(i, reach) };
        let plan = &mut self.plans[i];
        if let Some((contact, partner)) = best {
            (plan.contact, plan.partner, plan.stamp) = (contact, partner, self.grains[partner as usize].stamp);
        }
        self.queue.set(i, f64::min(plan.contact, plan.exit));
    }

    /// Earliest contact with a grain in the cells at offsets `reach`, if it is earlier than the planned one.
    fn contact<const ACCELERATED: bool>(&mut self, i: usize, reach: [[isize; 2]; 3]) -> Option<(f64, u32)> {
        let best = (self.plans[i].contact - self.now, NO_GRAIN);
        let size = GrowingDiameter { diameter: self.diameter(), growth: self.size.growth };
        let Self { grains, cells, near, flights, now, .. } = self;
        let grain = &grains[i];
        cells.near(cells.coordinates(grain.cell), reach, near);
        let (t, partner) = if ACCELERATED {
            self.first_on_curved_paths(i, best)
        } else {
            let view = FlightInput { grains, grain, now: *now, periods: cells.periods, size };
            flights.first(i, near.list(), &view, best)
        };
        (partner != NO_GRAIN).then_some((self.now + t, partner))
    }

    /// The first of the nearby grains that is met earlier than the best so far, for trajectories
    /// with different curvature.
    fn first_on_curved_paths(&mut self, i: usize, mut best: (f64, u32)) -> (f64, u32) {
        let (position, velocity) = (self.grains[i].position, self.grains[i].velocity);
        let acceleration = self.accelerations[i];
        let (diameter, limit) = (self.diameter(), self.plans[i].renewal - self.now);
        let mut chosen = std::mem::take(&mut self.curved_flights);
        let mut count = 0;
        for &j in self.near.list() {
            let pull = self.accelerations[j as usize];
            let (there, speed) = self.grains[j as usize].at(self.now, Some(pull));
            let start = RelativeFlight {
                separation: self.nearest(there - position),
                velocity: speed - velocity,
                acceleration: pull - acceleration,
            };
            chosen[count] = (j, start);
            count += usize::from(start.may_meet(diameter, limit)) & usize::from(j as usize != i);
        }
        for (j, start) in &chosen[..count] {
            if let Some(t) = curved_contact_time(start, diameter, f64::min(best.0, limit))
                && t < best.0
            {
                best = (t, *j);
            }
        }
        self.curved_flights = chosen;
        best
    }

    /// Time and way in which a grain leaves its cell: through a face, against a wall, or when its
    /// stored acceleration expires.
    fn exit(&self, i: usize, renewal: f64) -> (f64, Exit) {
        let grain = &self.grains[i];
        let (mut first, mut by) = (renewal - self.now, Exit::Renewal);
        let home = self.cells.coordinates(grain.cell);
        for axis in 0..3 {
            let (x, v) = (grain.position[axis], grain.velocity[axis]);
            let a = if self.accelerated { self.accelerations[i][axis] } else { 0.0 };
            let (edge, count) = (self.cells.edges[axis], self.cells.counts[axis]);
            let low = home[axis] as f64 * edge;
            let (radius, growth) = (0.5 * self.diameter(), 0.5 * self.size.growth);
            for up in [false, true] {
                let (v, a) = if up { (v, a) } else { (-v, -a) };
                let is_outermost = home[axis] == if up { count - 1 } else { 0 };
                let time = if !is_outermost || !self.cells.walled[axis] {
                    time_to_plane(if up { low + edge - x } else { x - low }, v, a)
                } else if up && axis == 1 && self.top_wall.is_free() {
                    f64::INFINITY
                } else {
                    time_to_plane(if up { edge * count as f64 - radius - x } else { x - radius }, growth + v, a)
                };
                if time < first {
                    (first, by) = (time, Exit::Face { axis: axis as u8, up });
                }
            }
        }
        (self.now + first, by)
    }
}
