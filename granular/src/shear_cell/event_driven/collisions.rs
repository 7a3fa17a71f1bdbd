//! The events: collisions with grains and walls, and transitions between cells.

use super::{
    super::{CollisionRule, Rebound, Side},
    EventDriven,
    cells::nearest_image,
};
use domain::Vector;

impl EventDriven {
    pub(super) fn pair_event(&mut self, i: usize, j: usize) {
        self.advance_grain(i);
        self.advance_grain(j);
        let (model, diameter) = (self.model, self.diameter());
        let radius = 0.5 * diameter;
        let separation = self.nearest(self.grains[j].position - self.grains[i].position);
        let distance = separation.length();
        let n = separation / distance;
        let rule = self.rule(model.parameters().grain_contact, &[i, j]);
        let (mut a, mut b) = (self.motion(i), self.motion(j));
        let before = a.energy(radius) + b.energy(radius);
        let pressing = if self.accelerated { (self.accelerations[i] - self.accelerations[j]).dot(n) } else { 0.0 };
        rule.strike_pair([&mut a, &mut b], n, radius, self.rebound(self.size.growth, pressing));
        self.set_motion(i, a);
        self.set_motion(j, b);
        let tally = &mut self.tally;
        tally.dissipated += (before - a.energy(radius) - b.energy(radius)) * model.mass();
        tally.pair_collisions += 1;
        let overlap = f64::max(1.0 - distance / diameter, 0.0);
        tally.overlaps += overlap;
        tally.largest_overlap = tally.largest_overlap.max(overlap);
        self.events.collisions += 1;
        for k in [i, j] {
            self.rotations[k].last_collision = self.now;
            self.change_path(k);
        }
        self.plan(i);
        self.plan(j);
    }

    /// A grain reaches a face of its cell: a wall, or the boundary of the next cell.
    pub(super) fn face_event(&mut self, i: usize, axis: usize, up: bool) {
        self.advance_grain(i);
        let (cells, grain) = (&mut self.cells, &mut self.grains[i]);
        let (mut home, n) = (cells.coordinates(grain.cell), cells.counts[axis]);
        let outermost = home[axis] == if up { n - 1 } else { 0 };
        if outermost && cells.walled[axis] {
            return self.wall_event(i, Side::of(axis, !up));
        }
        cells.leave(i as u32, grain.cell);
        if outermost {
            grain.position[axis] += if up { -cells.periods[axis] } else { cells.periods[axis] };
        }
        home[axis] = (home[axis] + if up { 1 } else { n - 1 }) % n;
        grain.cell = cells.index(home);
        cells.enter(i as u32, grain.cell);
        self.events.passages += 1;
        self.plan_after_passage(i, axis, up);
    }

    /// Collision with a wall of a grain that has been advanced to the present time.
    pub(super) fn wall_event(&mut self, i: usize, side: Side) {
        let (model, radius) = (self.model, 0.5 * self.diameter());
        let mut top_wall = self.top_wall.at(self.now);
        let wall = model.wall_contact(side, top_wall.velocity);
        let rule = self.rule(model.parameters().wall_contact, &[i]);
        let mut motion = self.motion(i);
        let before = motion.energy(radius);
        let mut pressing = -self.accelerations[i].dot(side.normal());
        if wall.mass_ratio > 0.0 {
            pressing += model.top_wall_acceleration();
        }
        let impulse = rule.strike_wall(&mut motion, &wall, radius, self.rebound(0.5 * self.size.growth, pressing));
        self.set_motion(i, motion);
        self.tally.strike_wall(&model, &wall, impulse, motion.energy(radius) - before, &mut top_wall);
        self.events.collisions += 1;
        self.rotations[i].last_collision = self.now;
        self.change_path(i);
        if wall.mass_ratio > 0.0 {
            self.top_wall.set(top_wall, self.now);
        }
        self.plan(i);
    }

    /// Collision parameters for a collision now: elastic if one of the grains collided within the contact time.
    fn rule(&mut self, rule: CollisionRule, grains: &[usize]) -> CollisionRule {
        let since = |&i: &usize| self.now - self.rotations[i].last_collision;
        if grains.iter().map(since).fold(f64::INFINITY, f64::min) >= self.model.parameters().contact_time {
            return rule;
        }
        self.tally.elastic_collisions += 1;
        CollisionRule { restitution: 1.0, ..rule }
    }

    /// Rebound that keeps two bodies apart for the contact time under an acceleration that presses them together.
    fn rebound(&self, growth: f64, pressing: f64) -> Rebound {
        Rebound { growth, least: 0.5 * self.model.parameters().contact_time * f64::max(pressing, 0.0) }
    }

    /// Nearest image of the separation of two grains in neighbouring cells.
    #[inline]
    pub(super) fn nearest(&self, separation: Vector) -> Vector {
        Vector::from(std::array::from_fn(|k| nearest_image(separation[k], self.cells.periods[k])))
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::{CellModel, CellParameters, CellState, Grains};
    use super::super::GrowingDiameter;
    use super::*;

    #[test]
    fn two_grains_see_each_other_in_opposite_directions() {
        let straight = CellParameters { circumference: None, ..CellParameters::default() };
        let parameters = CellParameters { length: 24.0, height: 8.0, width: 8.0, diameter: 1.0, ..straight };
        let model = CellModel::new(parameters).unwrap();
        let grains = Grains { positions: vec![], motions: vec![] };
        let size = GrowingDiameter { diameter: 1.0, growth: 0.0 };
        let engine = EventDriven::growing(&model, &CellState::new(&model, &grains), size);
        for (distance, nearest) in [(3.0, 3.0), (12.0, 12.0), (15.0, -9.0)] {
            let separation = Vector::new(distance, 5.0, -6.0);
            let expected = Vector::new(nearest, 5.0, -6.0);
            assert_eq!((engine.nearest(separation), engine.nearest(-separation)), (expected, -expected));
        }
    }
}
