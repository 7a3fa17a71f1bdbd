//! The box as time goes on.

use crate::integrator::VELOCITY_COLUMNS;
use crate::model::ShearRates;
use domain::{Particles, PeriodicBox, Vector};
use simulation::Clock;
use solver::BackgroundFlow;

/// A box in a shear flow, that shears with it or stays straight. Beyond each of its sides the flow is faster by
/// `G . lattice vector`, with `G` the velocity gradient: a particle that leaves on one side and enters on the other is
/// seen in another frame of reference from then on, and so is its past.
#[derive(Clone)]
pub struct MovingBox {
    start: PeriodicBox,
    rates: ShearRates,
    shears: bool,
    /// The flow as it is, and the step at which it became so.
    flow: BackgroundFlow,
    began: u64,
    cell: PeriodicBox,
    /// Whole periods that the lattice's strain has been turned back by since the start.
    turns: i32,
}

impl MovingBox {
    /// The box that is `start` at time zero, as it is after the last step of a clock, in a flow of rates of shear with which
    /// it shears, or does not.
    pub fn at(clock: &Clock, start: PeriodicBox, rates: ShearRates, shears: bool) -> Self {
        let (rate, began) = rates.before(clock.step());
        let flow = BackgroundFlow::shear(rate);
        let mut moving = Self { start, rates, shears, flow, began, cell: start, turns: 0 };
        (moving.cell, moving.turns) = moving.shape_at(clock.time());
        moving
    }

    /// The background flow.
    pub fn flow(&self) -> &BackgroundFlow {
        &self.flow
    }

    /// Changes the flow to what it is from a step on; whether that is another one.
    pub fn begin(&mut self, step: u64) -> bool {
        let changed = self.rates.changed_at(step);
        if let Some(rate) = changed {
            (self.flow, self.began) = (BackgroundFlow::shear(rate), step);
        }
        changed.is_some()
    }

    /// The step at which the flow became what it is.
    pub fn began(&self) -> u64 {
        self.began
    }

    /// The strain of the flow at a time.
    pub fn strain(&self, time: f64) -> f64 {
        self.rates.strain(time)
    }

    /// The box as it is.
    pub fn cell(&self) -> &PeriodicBox {
        &self.cell
    }

    /// The largest strain that the lattice ever has.
    pub fn largest_strain(&self) -> f64 {
        let edges = self.start.edges();
        let moves = self.shears && self.rates.largest() > 0.0;
        if moves { 0.5 * edges.x / edges.y } else { self.start.strain().abs() }
    }

    /// The velocity of the image that is `steps` lattice vectors away, relative to its particle.
    pub fn velocity_of_image(&self, steps: [i32; 3]) -> Vector {
        if self.shears { self.flow.gradient() * self.cell.lattice(steps) } else { Vector::ZERO }
    }

    fn shape_at(&self, time: f64) -> (PeriodicBox, i32) {
        let strain = self.start.strain() + if self.shears { self.rates.strain(time) } else { 0.0 };
        let cell = PeriodicBox::sheared(self.start.edges(), strain).expect("times and rates are finite");
        let period = cell.edges().x / cell.edges().y;
        (cell, ((strain - cell.strain()) / period).round() as i32)
    }

    /// Brings the box to a time and the particles into it.
    pub fn go_to(&mut self, time: f64, particles: &mut Particles) {
        let (cell, turns) = self.shape_at(time);
        if turns != self.turns {
            particles.relabel(turns - self.turns);
        }
        (self.cell, self.turns) = (cell, turns);
        if self.flow == BackgroundFlow::NONE {
            particles.wrap(&self.cell);
        } else {
            self.wrap_in_flow(particles);
        }
    }

    fn wrap_in_flow(&self, particles: &mut Particles) {
        let before = particles.steps.clone();
        particles.wrap(&self.cell);
        for (i, before) in before.iter().enumerate() {
            let now = particles.steps[i];
            if now == *before {
                continue;
            }
            let jump = self.flow.gradient() * self.cell.lattice(std::array::from_fn(|d| now[d] - before[d]));
            for column in particles.columns.iter_mut().filter(|c| VELOCITY_COLUMNS.contains(&c.name.as_str())) {
                let velocities: &mut [Vector] = bytemuck::cast_slice_mut(&mut column.values);
                velocities[i] -= jump;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::VELOCITY;
    use crate::integrator::{AdamsBashforth, advance};

    fn at_rate(step: u64, start: PeriodicBox, rate: f64) -> MovingBox {
        MovingBox::at(&Clock::at(step, 0.1), start, ShearRates::new(rate, &[], 0.1), true)
    }

    /// Carried by the flow alone, a particle's place without periodicity is known: `x0 + rate y0 t + drift t`, and the
    /// integrator is exact for it, whatever images it passes through and however often the lattice turns back.
    #[test]
    fn a_passing_particle_moves_on_a_straight_line() {
        let (rate, drift) = (0.7, Vector::new(0.1, 0.9, -0.4));
        let gradient = BackgroundFlow::shear(rate).gradient();
        let start = PeriodicBox::new(Vector::new(3.0, 2.0, 4.0)).unwrap();
        let mut moving = at_rate(0, start, rate);
        let mut particles = Particles::default();
        let from = Vector::new(1.0, 1.5, 0.2);
        particles.push(0, from, 0.1, 0);
        let flow = |particles: &mut Particles| {
            let velocities: Vec<Vector> = particles.positions.iter().map(|x| gradient * *x + drift).collect();
            particles.vectors(VELOCITY).copy_from_slice(&velocities);
        };
        flow(&mut particles);
        let mut clock = Clock::at(0, 0.05);
        for _ in 0..400 {
            let now = clock;
            advance(&mut particles, (clock.dt(), clock.step()), AdamsBashforth::Four, |particles, fraction| {
                moving.go_to(now.time_at(fraction), particles);
                flow(particles);
                Ok::<(), ()>(())
            })
            .unwrap();
            clock.tick();
        }
        let t = clock.time();
        let y = from.y + drift.y * t;
        let x = from.x + (drift.x + rate * from.y) * t + 0.5 * rate * drift.y * t * t;
        let exact = Vector::new(x, y, from.z + drift.z * t);
        let found = particles.positions[0] + moving.cell().lattice(particles.steps[0]);
        assert!((found - exact).length() < 1e-10 * exact.length(), "{found} is not {exact}");
        assert!(moving.turns >= 9, "the lattice turned back: {}", moving.turns);
    }

    #[test]
    fn a_box_taken_up_later_is_the_same() {
        let start = PeriodicBox::new(Vector::new(3.0, 2.0, 4.0)).unwrap();
        let mut moving = at_rate(0, start, 0.7);
        moving.go_to(0.1 * 137.0, &mut Particles::default());
        let later = at_rate(137, start, 0.7);
        assert_eq!((moving.cell, moving.turns), (later.cell, later.turns));
    }
}
