//! The simulation box in time: static, sheared (Lees-Edwards), stretched (Kraynik-Reinelt), or open.

mod advection;
mod remote;
#[cfg(test)]
mod tests;

use crate::columns::are_velocities;
use crate::flow::constant_flux::ConstantFluxState;
use crate::flow::kraynik_reinelt::{Matrix, Named, StretchingLattice};
use crate::flow::stress_control::{Search, StressControl, StressTarget};
use crate::model::{Extension, ShearRates};
use advection::carry_by;
use domain::parallel::{copied, equal};
use domain::{Boundaries, Particles, PeriodicBox, Scalars, Traceless, Vector};
use hydrodynamics::Poiseuille;
use hydrodynamics::StrainRate;
use simulation::Clock;
use solver::BackgroundFlow;

/// Longest strain of a substep under stress control: contacts stick or slide for a whole substep.
const LONGEST_STRAIN: f64 = 0.005;

/// A box in a flow: static, sheared with a shear flow, or stretched with an extension. In a shear flow the velocity of
/// the flow differs across a lattice vector by `G . lattice vector`, with `G` the velocity gradient: a particle that
/// leaves the box on one side and enters on the other changes its frame of reference, and its past velocities change
/// with it.
///
/// If the rate of the flow varies continuously, by an oscillation or under stress control, velocities, past ones
/// included, are relative to the flow while particles move, and the box advects both positions and velocities as it
/// shears, by `x += strain y`. So a multistep method keeps its order, and images that are displaced by exactly the
/// strain of the box have the same history. In extensions, which separate particles exponentially, this is always done,
/// by `x -> D x` with the stretch `D`; also in unbounded fluid, where no box stretches with the flow.
#[derive(Clone)]
pub struct PeriodicCell {
    start: PeriodicBox,
    rates: ShearRates,
    driven: Option<StressControl>,
    /// Pressure-driven flow without particles, and the state of the constant-flux constraint, if there are any.
    profile: Option<Poiseuille>,
    flux: Option<ConstantFluxState>,
    motion: CellMotion,
    /// Present rate and flow, and the step at which this rate began.
    rate: f64,
    flow: BackgroundFlow,
    flow_start_step: u64,
    time: f64,
    cell: PeriodicBox,
    vectors: Vectors,
}

/// Motion of the box.
#[derive(Clone, Copy)]
enum CellMotion {
    Still,
    Shearing,
    Stretching(StretchingLattice),
    /// Static box in an extension of unbounded fluid.
    Open(Extension),
}

/// Choice of the lattice vectors of the box.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Vectors {
    /// Vectors of a sheared lattice, reduced by this many periods of the strain since the start.
    Sheared(i32),
    Stretched(Named),
}

impl PeriodicCell {
    /// The box after the last step of a clock, if it is `start` at time zero; it shears with the flow of the given
    /// rates if `shears` is set.
    pub fn at(clock: &Clock, start: PeriodicBox, rates: ShearRates, shears: bool) -> Self {
        let (rate, flow_start_step) = rates.before(clock.step());
        let motion = if shears { CellMotion::Shearing } else { CellMotion::Still };
        let (flow, time, vectors) = (shear(&start, rate), clock.time(), Vectors::Sheared(0));
        let (driven, profile, flux) = (None, None, None);
        let mut moving = Self {
            start,
            rates,
            driven,
            profile,
            flux,
            motion,
            rate,
            flow,
            flow_start_step,
            time,
            cell: start,
            vectors,
        };
        (moving.cell, moving.vectors) = moving.shape_at(time);
        moving
    }

    /// This box in an extension with its rates. A periodic box has to be one that repeats in this extension; in open
    /// fluid any box will do.
    #[must_use]
    pub fn in_extension(mut self, extension: Extension) -> Self {
        self.motion = match self.start.boundaries() {
            Boundaries::Periodic => CellMotion::Stretching(StretchingLattice::new(extension, &self.start)),
            _ => CellMotion::Open(extension),
        };
        self.set_rate(self.rate);
        (self.cell, self.vectors) = self.shape_at(self.time);
        self
    }

    /// This box with a pressure-driven flow in addition, if there is one.
    #[must_use]
    pub fn with_profile(self, profile: Option<Poiseuille>) -> Self {
        Self { profile, ..self }
    }

    /// This box with a pressure-driven flow at constant flux, or at constant pressure gradient for `None`.
    #[must_use]
    pub fn at_constant_flux(self, flux: Option<ConstantFluxState>) -> Self {
        Self { flux, ..self }
    }

    /// State of the constant-flux constraint, if the flux is kept.
    pub fn flux(&mut self) -> Option<&mut ConstantFluxState> {
        self.flux.as_mut()
    }

    /// Flow of the total pressure gradient; at constant flux it differs from the flow without particles.
    pub fn total_poiseuille(&self) -> Option<Poiseuille> {
        let besides = self.flux.map_or(0.0, ConstantFluxState::curvature);
        self.profile.map(|profile| Poiseuille { curvature: profile.curvature + besides, ..profile })
    }

    /// Change of the pressure-driven flow by the particles at constant flux.
    pub fn flux_correction(&self) -> Option<Poiseuille> {
        self.profile.zip(self.flux).map(|(profile, flux)| Poiseuille { curvature: flux.curvature(), ..profile })
    }

    /// Whether the flux is kept constant.
    pub fn keeps_flux(&self) -> bool {
        self.flux.is_some()
    }

    /// Velocity of a free sphere at a position in the background flow.
    pub fn velocity_of(&self, place: Vector, radius: f64) -> Vector {
        let sheared = self.flow.velocity(place);
        self.profile.map_or(sheared, |profile| sheared + profile.velocity_of(place.z, radius))
    }

    /// The part of [`Self::velocity_of`] that velocities include while particles move.
    pub fn carried_velocity_of(&self, place: Vector, radius: f64) -> Vector {
        if self.advects() { Vector::ZERO } else { self.velocity_of(place, radius) }
    }

    /// Angular velocity of a free sphere at a position in the background flow.
    pub fn angular_velocity_at(&self, place: Vector) -> Vector {
        let sheared = self.flow.angular_velocity();
        self.profile.map_or(sheared, |profile| sheared + profile.angular_velocity(place.z))
    }

    /// Strain rate of the background flow.
    pub fn strain_rate(&self) -> StrainRate {
        let sheared = StrainRate::uniform(self.flow.strain_rate());
        self.profile.map_or(sheared, |profile| sheared + profile.strain_rate())
    }

    /// This box under stress control, with `stress` the shear stress, the viscosity and the tolerance of solves; the
    /// state is restored from scalars, if they have it.
    #[must_use]
    pub fn under_stress(mut self, target: StressTarget, scalars: &Scalars) -> Self {
        let driven = StressControl::start(target, self.rate).restored(scalars);
        self.driven = Some(driven);
        self.set_rate(driven.rate());
        (self.cell, self.vectors) = self.shape_at(self.time);
        self
    }

    /// State of the stress control, if the stress is given.
    pub fn driven(&mut self) -> Option<&mut StressControl> {
        self.driven.as_mut()
    }

    /// A search for the rate at the given stress, if the stress is given.
    pub fn search(&self) -> Option<Search> {
        self.driven.as_ref().map(StressControl::search)
    }

    /// Continues with another rate.
    pub fn set_rate(&mut self, rate: f64) {
        self.rate = rate;
        self.flow = match &self.motion {
            CellMotion::Stretching(lattice) => lattice.kind().flow(rate),
            CellMotion::Open(extension) => extension.flow(rate),
            CellMotion::Still | CellMotion::Shearing => shear(&self.start, rate),
        };
    }

    /// Rate of shear or extension.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Strain rate of the flow at the predicted rate minus that at the present rate.
    pub fn predicted_strain_rate_change(&self) -> Traceless {
        let missing = self.driven.as_ref().map_or(0.0, |driven| driven.expected() - self.rate);
        shear(&self.start, missing).strain_rate()
    }

    /// Whether the flow has almost stopped under its stress.
    pub fn is_jammed(&self) -> bool {
        self.driven.as_ref().is_some_and(StressControl::is_jammed)
    }

    /// Longest substep allowed by the flow.
    pub fn longest_substep(&self) -> f64 {
        self.driven.as_ref().map_or(f64::INFINITY, |driven| LONGEST_STRAIN / driven.rate().abs())
    }

    /// Background flow.
    pub fn flow(&self) -> &BackgroundFlow {
        &self.flow
    }

    /// Changes the flow to that from `step` on. Returns whether it has changed.
    pub fn begin(&mut self, step: u64) -> bool {
        let changed = self.rates.changed_at(step);
        if let Some(rate) = changed {
            self.set_rate(rate);
            self.flow_start_step = step;
        }
        changed.is_some()
    }

    /// Step at which the present rate began.
    pub fn flow_start_step(&self) -> u64 {
        self.flow_start_step
    }

    /// Strain of the flow at a time.
    pub fn strain(&self, time: f64) -> f64 {
        self.driven.as_ref().map_or_else(|| self.rates.strain(time), StressControl::strain)
    }

    /// Present box.
    pub fn cell(&self) -> &PeriodicBox {
        &self.cell
    }

    /// Continues with a box that follows the particles.
    pub fn follow(&mut self, cell: PeriodicBox) {
        (self.start, self.cell) = (cell, cell);
    }

    /// Largest strain of the lattice at any time.
    pub fn largest_strain(&self) -> f64 {
        let edges = self.start.edges();
        let moves = self.rates.largest() > 0.0;
        match self.motion {
            CellMotion::Shearing if moves => 0.5 * edges.x / edges.y,
            CellMotion::Stretching(lattice) => lattice.kind().extremes().strain,
            CellMotion::Shearing | CellMotion::Still | CellMotion::Open(_) => self.start.strain().abs(),
        }
    }

    /// Velocity of the image `steps` lattice vectors away, relative to its particle.
    pub fn velocity_of_image(&self, steps: [i32; 3]) -> Vector {
        self.flow_of_images().velocity(self.cell.lattice(steps))
    }

    /// The flow by which images move relative to their particles.
    pub fn flow_of_images(&self) -> BackgroundFlow {
        let moves = matches!(self.motion, CellMotion::Shearing) && !self.advects();
        if moves { self.flow } else { BackgroundFlow::NONE }
    }

    fn shape_at(&self, time: f64) -> (PeriodicBox, Vectors) {
        if let CellMotion::Stretching(lattice) = &self.motion {
            let (cell, named) = lattice.at(self.strain(time));
            return (cell, Vectors::Stretched(named));
        }
        if self.start.boundaries() != Boundaries::Periodic {
            return (self.start, Vectors::Sheared(0));
        }
        let strain = self.start.strain() + if let CellMotion::Shearing = self.motion { self.strain(time) } else { 0.0 };
        let cell = PeriodicBox::sheared(self.start.edges(), strain).expect("times and rates are finite");
        let period = cell.edges().x / cell.edges().y;
        (cell, Vectors::Sheared(((strain - cell.strain()) / period).round() as i32))
    }

    /// Advances the box to a time, and advects and wraps the particles.
    pub fn advance_to(&mut self, time: f64, particles: &mut Particles) {
        if let Some(driven) = &mut self.driven {
            let (strain, rate) = (driven.go(), driven.expected());
            carry_by(self.deformation(strain), particles);
            self.set_rate(rate);
        } else if self.advects() {
            carry_by(self.deformation_to(time), particles);
            self.set_rate_at(time);
        }
        self.time = time;
        let (cell, vectors) = self.shape_at(time);
        if vectors != self.vectors {
            particles.relabel(&self.renamed(vectors));
        }
        (self.cell, self.vectors) = (cell, vectors);
        if self.advects() || self.flow == BackgroundFlow::NONE {
            particles.wrap(&self.cell);
        } else {
            self.wrap_in_flow(particles);
        }
    }

    /// Matrix that converts lattice steps to other vectors of the box.
    fn renamed(&self, vectors: Vectors) -> Matrix {
        match (&self.motion, self.vectors, vectors) {
            (_, Vectors::Sheared(before), Vectors::Sheared(now)) => [[1, now - before, 0], [0, 1, 0], [0, 0, 1]],
            (CellMotion::Stretching(lattice), Vectors::Stretched(before), Vectors::Stretched(now)) => {
                lattice.renamed(&before, &now)
            }
            _ => unreachable!("a box moves in one way"),
        }
    }

    fn wrap_in_flow(&self, particles: &mut Particles) {
        let before = copied(&particles.steps);
        particles.wrap(&self.cell);
        if equal(&before, &particles.steps) {
            return;
        }
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

/// All columns of velocities.
fn velocities(particles: &mut Particles) -> impl Iterator<Item = &mut [Vector]> {
    let columns = particles.columns.iter_mut().filter(|c| are_velocities(&c.name));
    columns.map(|column| bytemuck::cast_slice_mut(&mut column.values))
}

/// Shear flow of a rate in a box: its gradient is along y, or along z between walls.
fn shear(cell: &PeriodicBox, rate: f64) -> BackgroundFlow {
    if cell.gradient_axis() == 2 { BackgroundFlow::couette(rate) } else { BackgroundFlow::shear(rate) }
}
