//! The box as time goes on.

use crate::deformation::Deformation;
use crate::driven::{Driven, Search};
use crate::integrator::VELOCITY_COLUMNS;
use crate::model::{Extension, ShearRates};
use crate::pressure_flow::PressureFlow;
use crate::stretching::{Matrix, Named, StretchingLattice};
use domain::{Boundaries, Comm, Particles, PeriodicBox, Traceless, Vector};
use hydrodynamics::Poiseuille;
use hydrodynamics::StrainRate;
use simulation::Clock;
use solver::BackgroundFlow;

/// Where a stress drives the flow, substeps are at most this long in strain: contacts stick or slide for all of one.
const LONGEST_STRAIN: f64 = 0.005;

/// A box in a shear flow, that shears with it or stays straight, or in an extension. In a shear flow, beyond each of its
/// sides the flow is faster by `G . lattice vector`, with `G` the velocity gradient: a particle that leaves on one side and
/// enters on the other is seen in another frame of reference from then on, and so is its past.
///
/// Where the rate of the flow changes all the time, by an oscillation or since the stress is given, the particles are
/// in the frame of the flow while they move: their velocities, past ones too, are relative to it, and the box carries
/// them along as it shears, by `x += strain y` for places and velocities alike. So a multistep method for the
/// velocities keeps its order, and images that move apart by exactly the strain of the box see the same past. In an
/// extension, which carries particles away from each other exponentially, it is always so, `x -> D x` with its stretch `D`: in open
/// fluid too, where the flow goes on without a box that does.
#[derive(Clone)]
pub struct MovingBox {
    start: PeriodicBox,
    rates: ShearRates,
    driven: Option<Driven>,
    /// A flow by a pressure gradient besides, and that of particles which keeps its flux, if it is kept.
    profile: Option<Poiseuille>,
    flux: Option<PressureFlow>,
    motion: Motion,
    /// The flow as it is, by its rate, and the step at which it became so.
    rate: f64,
    flow: BackgroundFlow,
    began: u64,
    time: f64,
    cell: PeriodicBox,
    vectors: Vectors,
}

/// How the box moves.
#[derive(Clone, Copy)]
enum Motion {
    Still,
    Shearing,
    Stretching(StretchingLattice),
    /// Not with the flow, which is an extension of open fluid.
    Open(Extension),
}

/// Which vectors of its lattice the box has.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Vectors {
    /// Those of a lattice that was turned back by so many periods of its strain since the start.
    Sheared(i32),
    Stretched(Named),
}

impl MovingBox {
    /// The box that is `start` at time zero, as it is after the last step of a clock, in a flow of rates of shear with which
    /// it shears, or does not.
    pub fn at(clock: &Clock, start: PeriodicBox, rates: ShearRates, shears: bool) -> Self {
        let (rate, began) = rates.before(clock.step());
        let motion = if shears { Motion::Shearing } else { Motion::Still };
        let (flow, time, vectors) = (shear(&start, rate), clock.time(), Vectors::Sheared(0));
        let (driven, profile, flux) = (None, None, None);
        let mut moving =
            Self { start, rates, driven, profile, flux, motion, rate, flow, began, time, cell: start, vectors };
        (moving.cell, moving.vectors) = moving.shape_at(time);
        moving
    }

    /// The same where the rates are those of an extension, and the box is the one of that, or in open fluid any.
    #[must_use]
    pub fn in_extension(mut self, extension: Extension) -> Self {
        self.motion = match self.start.boundaries() {
            Boundaries::Periodic => Motion::Stretching(StretchingLattice::new(extension, &self.start)),
            _ => Motion::Open(extension),
        };
        self.set_rate(self.rate);
        (self.cell, self.vectors) = self.shape_at(self.time);
        self
    }

    /// The same with a flow by a pressure gradient besides, if there is one.
    #[must_use]
    pub fn with_profile(self, profile: Option<Poiseuille>) -> Self {
        Self { profile, ..self }
    }

    /// The same with a flow by a pressure gradient that keeps its flux, or does not.
    #[must_use]
    pub fn at_constant_flux(self, flux: Option<PressureFlow>) -> Self {
        Self { flux, ..self }
    }

    /// What keeps the flux, if it is kept.
    pub fn flux(&mut self) -> Option<&mut PressureFlow> {
        self.flux.as_mut()
    }

    /// The flow of the pressure gradient that there is, which with a flux that is kept is another one than without particles.
    pub fn by_pressure(&self) -> Option<Poiseuille> {
        let besides = self.flux.map_or(0.0, PressureFlow::curvature);
        self.profile.map(|profile| Poiseuille { curvature: profile.curvature + besides, ..profile })
    }

    /// The flow of a pressure gradient that keeps the flux, besides that which there is without particles.
    pub fn by_particles(&self) -> Option<Poiseuille> {
        self.profile.zip(self.flux).map(|(profile, flux)| Poiseuille { curvature: flux.curvature(), ..profile })
    }

    /// Whether the flux is kept.
    pub fn keeps_flux(&self) -> bool {
        self.flux.is_some()
    }

    /// The velocity of a free sphere of a radius at a place of the background flow.
    pub fn velocity_of(&self, place: Vector, radius: f64) -> Vector {
        let sheared = self.flow.velocity(place);
        self.profile.map_or(sheared, |profile| sheared + profile.velocity_of(place.z, radius))
    }

    /// What velocities have of that while particles move.
    pub fn carried_velocity_of(&self, place: Vector, radius: f64) -> Vector {
        if self.carries() { Vector::ZERO } else { self.velocity_of(place, radius) }
    }

    /// The angular velocity of a free sphere at a place of the background flow.
    pub fn angular_velocity_at(&self, place: Vector) -> Vector {
        let sheared = self.flow.angular_velocity();
        self.profile.map_or(sheared, |profile| sheared + profile.angular_velocity(place.z))
    }

    /// The rate of strain of the background flow.
    pub fn strain_rate(&self) -> StrainRate {
        let sheared = StrainRate::uniform(self.flow.strain_rate());
        self.profile.map_or(sheared, |profile| sheared + profile.strain_rate())
    }

    /// The same with a rate of shear that a stress in a fluid of a viscosity drives, by solves of a tolerance, as
    /// particles on the first rank remember it. Collective.
    #[must_use]
    pub fn driven_by(mut self, stress: (f64, f64, f64), particles: &Particles, comm: &Comm) -> Self {
        let driven = Driven::start(stress, self.rate).recalled(particles, comm);
        self.driven = Some(driven);
        self.set_rate(driven.rate());
        (self.cell, self.vectors) = self.shape_at(self.time);
        self
    }

    /// The flow that a stress drives, if one does.
    pub fn driven(&mut self) -> Option<&mut Driven> {
        self.driven.as_mut()
    }

    /// A search for the rate that the stress drives, if one does.
    pub fn search(&self) -> Option<Search> {
        self.driven.as_ref().map(Driven::search)
    }

    /// Goes on with another rate.
    pub fn set_rate(&mut self, rate: f64) {
        self.rate = rate;
        self.flow = match &self.motion {
            Motion::Stretching(lattice) => lattice.kind().flow(rate),
            Motion::Open(extension) => extension.flow(rate),
            Motion::Still | Motion::Shearing => shear(&self.start, rate),
        };
    }

    /// The rate of the flow, of shear or extension.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// The rate of strain that was expected besides that of the flow.
    pub fn expected_besides(&self) -> Traceless {
        let missing = self.driven.as_ref().map_or(0.0, |driven| driven.expected() - self.rate);
        shear(&self.start, missing).strain_rate()
    }

    /// Whether a stress drives it that has next to no effect.
    pub fn is_jammed(&self) -> bool {
        self.driven.as_ref().is_some_and(Driven::is_jammed)
    }

    /// The longest substep that is known to be short enough for the flow.
    pub fn longest_substep(&self) -> f64 {
        self.driven.as_ref().map_or(f64::INFINITY, |driven| LONGEST_STRAIN / driven.rate().abs())
    }

    /// Whether velocities are relative to the flow while particles move.
    pub fn carries(&self) -> bool {
        self.rates.frequency().is_some()
            || self.driven.is_some()
            || matches!(self.motion, Motion::Stretching(_) | Motion::Open(_))
    }

    /// What the box does to the particles that it carries, in the time that comes; `weights` are those of the rates of now,
    /// before, and the mean of the last substep.
    pub fn carry(&self, duration: f64, weights: [f64; 3]) -> Deformation {
        self.deformation(match &self.driven {
            Some(driven) => driven.carry(weights),
            None if self.carries() => self.rates.strain(self.time + duration) - self.rates.strain(self.time),
            None => 0.0,
        })
    }

    /// What the flow does by a strain.
    pub fn deformation(&self, strain: f64) -> Deformation {
        match &self.motion {
            Motion::Stretching(lattice) => Deformation::Stretch(lattice.kind().stretch(strain)),
            Motion::Open(extension) => Deformation::Stretch(extension.stretch(strain)),
            Motion::Still | Motion::Shearing => Deformation::Shear(Vector::AXES[self.start.gradient_axis()] * strain),
        }
    }

    /// The background flow.
    pub fn flow(&self) -> &BackgroundFlow {
        &self.flow
    }

    /// Changes the flow to what it is from a step on; whether that is another one.
    pub fn begin(&mut self, step: u64) -> bool {
        let changed = self.rates.changed_at(step);
        if let Some(rate) = changed {
            self.set_rate(rate);
            self.began = step;
        }
        changed.is_some()
    }

    /// The step at which the flow became what it is.
    pub fn began(&self) -> u64 {
        self.began
    }

    /// The strain of the flow at a time.
    pub fn strain(&self, time: f64) -> f64 {
        self.driven.as_ref().map_or_else(|| self.rates.strain(time), Driven::strain)
    }

    /// The box as it is.
    pub fn cell(&self) -> &PeriodicBox {
        &self.cell
    }

    /// Goes on with a box that follows the particles.
    pub fn follow(&mut self, cell: PeriodicBox) {
        (self.start, self.cell) = (cell, cell);
    }

    /// The largest strain that the lattice ever has.
    pub fn largest_strain(&self) -> f64 {
        let edges = self.start.edges();
        let moves = self.rates.largest() > 0.0;
        match self.motion {
            Motion::Shearing if moves => 0.5 * edges.x / edges.y,
            Motion::Stretching(lattice) => lattice.kind().extremes().strain,
            Motion::Shearing | Motion::Still | Motion::Open(_) => self.start.strain().abs(),
        }
    }

    /// The velocity of the image that is `steps` lattice vectors away, relative to its particle.
    pub fn velocity_of_image(&self, steps: [i32; 3]) -> Vector {
        let moves = matches!(self.motion, Motion::Shearing) && !self.carries();
        if moves { self.flow.velocity(self.cell.lattice(steps)) } else { Vector::ZERO }
    }

    fn shape_at(&self, time: f64) -> (PeriodicBox, Vectors) {
        if let Motion::Stretching(lattice) = &self.motion {
            let (cell, named) = lattice.at(self.strain(time));
            return (cell, Vectors::Stretched(named));
        }
        if self.start.boundaries() != Boundaries::Periodic {
            return (self.start, Vectors::Sheared(0));
        }
        let strain = self.start.strain() + if let Motion::Shearing = self.motion { self.strain(time) } else { 0.0 };
        let cell = PeriodicBox::sheared(self.start.edges(), strain).expect("times and rates are finite");
        let period = cell.edges().x / cell.edges().y;
        (cell, Vectors::Sheared(((strain - cell.strain()) / period).round() as i32))
    }

    /// Brings the box to a time and the particles into it.
    pub fn go_to(&mut self, time: f64, particles: &mut Particles) {
        if let Some(driven) = &mut self.driven {
            let (strain, rate) = (driven.go(), driven.expected());
            carry_by(self.deformation(strain), particles);
            self.set_rate(rate);
        } else if self.carries() {
            let strain = self.rates.strain(time) - self.rates.strain(self.time);
            carry_by(self.deformation(strain), particles);
            if self.rates.frequency().is_some() {
                self.set_rate(self.rates.before_time(time));
            }
        }
        self.time = time;
        let (cell, vectors) = self.shape_at(time);
        if vectors != self.vectors {
            particles.relabel(&self.renamed(vectors));
        }
        (self.cell, self.vectors) = (cell, vectors);
        if self.carries() || self.flow == BackgroundFlow::NONE {
            particles.wrap(&self.cell);
        } else {
            self.wrap_in_flow(particles);
        }
    }

    /// By what lattice steps are to be multiplied where the box takes other vectors.
    fn renamed(&self, vectors: Vectors) -> Matrix {
        match (&self.motion, self.vectors, vectors) {
            (_, Vectors::Sheared(before), Vectors::Sheared(now)) => [[1, now - before, 0], [0, 1, 0], [0, 0, 1]],
            (Motion::Stretching(lattice), Vectors::Stretched(before), Vectors::Stretched(now)) => {
                lattice.renamed(&before, &now)
            }
            _ => unreachable!("a box moves in one way"),
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
            for velocities in velocities(particles) {
                velocities[i] -= jump;
            }
        }
    }
}

/// The columns of velocities.
fn velocities(particles: &mut Particles) -> impl Iterator<Item = &mut [Vector]> {
    let columns = particles.columns.iter_mut().filter(|c| VELOCITY_COLUMNS.contains(&c.name.as_str()));
    columns.map(|column| bytemuck::cast_slice_mut(&mut column.values))
}

/// The shear flow of a rate in a box: with a gradient along y, or along z where walls are across that.
fn shear(cell: &PeriodicBox, rate: f64) -> BackgroundFlow {
    if cell.gradient_axis() == 2 { BackgroundFlow::couette(rate) } else { BackgroundFlow::shear(rate) }
}

/// Carries particles along with a flow, and their velocities relative to it.
fn carry_by(deformation: Deformation, particles: &mut Particles) {
    let carry = |vectors: &mut [Vector]| vectors.iter_mut().for_each(|vector| *vector = deformation.of(*vector));
    carry(&mut particles.positions);
    velocities(particles).for_each(carry);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::VELOCITY;
    use crate::integrator::{AdamsBashforth, advance};
    use crate::model::Protocol;

    fn at_rate(step: u64, start: PeriodicBox, rate: f64) -> MovingBox {
        MovingBox::at(&Clock::at(step, 0.1), start, ShearRates::new(rate, Protocol::STEADY, 0.1), true)
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
        assert!(matches!(moving.vectors, Vectors::Sheared(9..)), "the lattice turned back: {:?}", moving.vectors);
    }

    /// In a flow that oscillates, a particle that drifts relative to it is `x' = rate cos(w t) y + drift`; the error is that of
    /// the method, whatever images it passes through, and none for a particle that does not drift.
    #[test]
    fn a_drifting_particle_follows_an_oscillation() {
        let (rate, w, start) = (1.2, 3.0, PeriodicBox::new(Vector::new(3.0, 2.0, 4.0)).unwrap());
        let (end, from) = (2.0, Vector::new(1.0, 1.5, 0.2));
        let error = |drift: Vector, dt: f64| {
            let rates = ShearRates::new(rate, Protocol::Oscillation { frequency: w }, dt);
            let mut moving = MovingBox::at(&Clock::at(0, dt), start, rates, true);
            let mut particles = Particles::default();
            particles.push(0, from, 0.1, 0);
            particles.vectors(VELOCITY).fill(drift);
            let mut clock = Clock::at(0, dt);
            while clock.time() < end - 0.5 * dt {
                let now = clock;
                let go = |particles: &mut Particles, fraction| {
                    moving.go_to(now.time_at(fraction), particles);
                    particles.vectors(VELOCITY).fill(drift);
                    Ok::<(), ()>(())
                };
                advance(&mut particles, (clock.dt(), clock.step()), AdamsBashforth::Four, go).unwrap();
                clock.tick();
            }
            // The integral of rate cos(w t) (y0 + drift t)
            let (sin, cos) = (w * end).sin_cos();
            let sheared = rate / w * (sin * (from.y + drift.y * end) + drift.y * (cos - 1.0) / w);
            let exact = from + drift * end + Vector::X * sheared;
            (particles.positions[0] + moving.cell().lattice(particles.steps[0]) - exact).length()
        };
        assert!(error(Vector::ZERO, 0.05) < 1e-13, "{}", error(Vector::ZERO, 0.05));
        let drift = Vector::new(0.1, 1.9, -0.4);
        let order = (error(drift, 0.01) / error(drift, 0.005)).log2();
        assert!((order - 4.0).abs() < 0.2, "order {order}");
    }

    #[test]
    fn a_box_taken_up_later_is_the_same() {
        let start = PeriodicBox::new(Vector::new(3.0, 2.0, 4.0)).unwrap();
        let mut moving = at_rate(0, start, 0.7);
        moving.go_to(0.1 * 137.0, &mut Particles::default());
        let later = at_rate(137, start, 0.7);
        assert_eq!((moving.cell, moving.vectors), (later.cell, later.vectors));
    }
}
