//! Statistics of a suspension, in the course of a run or from its trajectory.

mod background;
mod channel;
mod memory;
mod paths;
mod tables;

use crate::columns::ANGULAR_VELOCITY;
use crate::columns::VELOCITY;
use crate::model::{Axis, Extension, Flow, Model, Multipoles, ShearRates, Species, Statistics as Wanted};
use background::Flows;
use channel::{Channel, MORE_COLUMNS};
use domain::{Boundaries, Bytes, Particles, PeriodicBox, Vector, power_of_two};
pub use memory::{bytes, sample_bytes, state_bytes};
use paths::Paths;
use solver::BackgroundFlow;
use statistics::{
    Angle, Blocks, Fluctuations, Histogram, Lagrangian, Moduli, PairDistribution, Profile, SpeciesColumns, State, Store,
};
use std::borrow::Cow;

/// The columns that a sample needs.
pub const COLUMNS: [&str; 2] = [VELOCITY, ANGULAR_VELOCITY];

/// Everything that is averaged, in the axes of the user. All particles of a sample have to be on one rank, in the order of
/// their ids, so that results do not depend on the number of ranks.
pub struct Statistics {
    about: About,
    /// First time, last time, and samples.
    times: [f64; 3],
    velocities: Vec<Vectors>,
    angular_velocities: Vec<Vectors>,
    paths: Paths,
    lagrangian: Lagrangian,
    /// In a box that repeats along all axes.
    pairs: Option<PairDistribution>,
    profile: Option<Profile>,
    /// In one with walls, a wall, or open along z.
    channel: Option<Channel>,
    segregation: Blocks,
    /// In a flow that oscillates.
    moduli: Option<Moduli>,
    /// The pressure gradient, where it keeps the flux.
    pressure: Option<Blocks>,
}

/// What a sample is taken of.
#[derive(Debug, Clone, Copy)]
pub struct Sample<'a> {
    /// When.
    pub time: f64,
    /// The rate of the flow then.
    pub rate: f64,
    /// The box, in the axes of the user.
    pub cell: &'a PeriodicBox,
    /// All particles, with the columns [`COLUMNS`].
    pub particles: &'a Particles,
    /// The stress of the whole suspension that drives the flow, if that is known.
    pub shear_stress: Option<f64>,
    /// The pressure gradient that keeps the flux, if it is kept and known.
    pub pressure_gradient: Option<f64>,
}

/// What the samples have in common.
struct About {
    names: Vec<String>,
    /// Radius and volume fraction of each species.
    species: Vec<(f64, f64)>,
    /// The flow, at its largest rate if that changes, and its rates in time.
    flow: BackgroundFlow,
    flows: Flows,
    /// Along which axes the flow carries spheres.
    carries: [bool; 3],
    /// Edges of the box without strain.
    edges: Vector,
    rates: ShearRates,
    rigid: bool,
    axis: usize,
    /// By which separations of pairs are told apart.
    angle: Angle,
    columns: SpeciesColumns,
    wanted: Wanted,
}

/// The moments of a vector of the particles of a species, and the densities of its components about the mean at each
/// time, in a unit in which fourth powers are within range.
struct Vectors {
    unit: f64,
    moments: Fluctuations,
    densities: [Histogram; 3],
}

/// Numbers up to this, and down to one over it, are averaged as they come.
const ORDINARY: f64 = 1e36;

impl Vectors {
    /// Nothing so far, for vectors whose size is about this.
    fn about(size: f64) -> Self {
        let is_ordinary = (1.0 / ORDINARY..ORDINARY).contains(&size);
        let unit = if is_ordinary { 1.0 } else { power_of_two(size) };
        Self { unit, moments: Fluctuations::default(), densities: std::array::from_fn(|_| Histogram::default()) }
    }

    fn add(&mut self, vectors: impl Iterator<Item = Vector> + Clone) {
        let over = 1.0 / self.unit;
        let vectors = vectors.map(|vector| vector * over);
        let mean = vectors.clone().sum::<Vector>() / vectors.clone().count().max(1) as f64;
        for vector in vectors.clone() {
            for (density, value) in self.densities.iter_mut().zip((vector - mean).to_array()) {
                density.add(value);
            }
        }
        self.moments.add(vectors);
    }
}

/// The largest distance of pairs, in largest radii, unless the scene says it or the box is smaller.
const DISTANCE: f64 = 8.0;
/// Width of the columns of segregation, in largest radii.
const COLUMN_WIDTH: f64 = 4.0;

impl Statistics {
    /// Nothing so far, for a scene whose particles are given in the order of their ids.
    pub fn new(model: &Model, wanted: Wanted, particles: &Particles) -> Self {
        let about = About::of(model, wanted, particles);
        let speed = speed(model);
        let each = |size: f64| about.names.iter().map(|_| Vectors::about(size)).collect();
        let largest = particles.radii.iter().copied().fold(0.0, f64::max);
        let is_periodic = model.cell.boundaries() == Boundaries::Periodic;
        let distance = wanted.distance.unwrap_or(DISTANCE * largest).min(model.cell.edges().min_element());
        Self {
            times: [f64::NAN, f64::NAN, 0.0],
            velocities: each(speed),
            angular_velocities: each(if largest > 0.0 { speed / largest } else { 1.0 }),
            paths: Paths::default(),
            lagrangian: Lagrangian::new(&particles.species),
            pairs: is_periodic
                .then(|| PairDistribution::new(distance, about.angle, &particles.species, model.cell.volume())),
            profile: is_periodic.then(|| Profile::new(&model.cell, about.axis, about.names.len())),
            channel: Channel::of(model, wanted),
            segregation: Blocks::default(),
            moduli: about.rates.frequency().map(|w| Moduli::new(about.rates.largest() / w, w)),
            pressure: model.flow.keeps_flux().then(Blocks::default),
            about,
        }
    }

    /// Takes a sample, unless it is too early for it.
    pub fn sample(&mut self, &Sample { time, rate, cell, particles, shear_stress, pressure_gradient }: &Sample) {
        if time < self.about.wanted.from {
            return;
        }
        let flow = self.about.flows.at_rate(rate);
        let velocities = column(particles, VELOCITY).iter().zip(particles.positions.iter().zip(&particles.radii));
        let velocities: Vec<Vector> = velocities.map(|(&v, (&x, &a))| v - flow.velocity_of(x, a)).collect();
        each_species(&mut self.velocities, &particles.species, &velocities);
        if self.about.rigid {
            let turning = column(particles, ANGULAR_VELOCITY).iter().zip(&particles.positions);
            let turning = turning.map(|(&w, &x)| w - flow.angular_velocity_at(x));
            each_species(&mut self.angular_velocities, &particles.species, &turning.collect::<Vec<_>>());
        }
        let motions = self.paths.follow(time, (cell, particles), &velocities, self.about.carries);
        self.lagrangian.add(time, &motions);
        if let Some(pairs) = &mut self.pairs {
            pairs.add(cell, &particles.positions, &particles.species);
        }
        if let Some(profile) = &mut self.profile {
            profile.add(&in_lattice(cell, self.about.edges, particles), &particles.radii, &particles.species);
        }
        if let Some(channel) = &mut self.channel {
            channel.add(particles, &velocities);
        }
        self.segregation.add(counted((&self.about.columns, self.about.edges), (cell, particles)).intensity());
        if let (Some(moduli), Some(stress)) = (&mut self.moduli, shear_stress) {
            moduli.add(time, stress);
        }
        if let (Some(pressure), Some(gradient)) = (&mut self.pressure, pressure_gradient) {
            pressure.add(gradient);
        }
        let [first, _, samples] = self.times;
        self.times = [if samples == 0.0 { time } else { first }, time, samples + 1.0];
    }
}

impl About {
    fn of(model: &Model, wanted: Wanted, particles: &Particles) -> Self {
        let rates = model.shear_rates();
        let (flows, rate) = (Flows::of(model), if rates.is_constant() { rates.before(0).0 } else { rates.largest() });
        let flow = flows.linear(rate);
        let fraction = |index: usize| {
            let own = particles.species.iter().zip(&particles.radii).filter(|(s, _)| **s as usize == index);
            own.map(|(_, a)| 4.0 / 3.0 * std::f64::consts::PI * a.powi(3)).sum::<f64>() / model.cell.volume()
        };
        Self {
            names: model.species.iter().map(|s| s.name.clone()).collect(),
            species: model.species.iter().enumerate().map(|(index, s)| (s.radius, fraction(index))).collect(),
            flow,
            carries: flows.carries(rate),
            flows,
            edges: model.cell.edges(),
            rates,
            rigid: model.hydrodynamics.multipoles == Multipoles::Dipole,
            axis: axis(model, wanted.axis),
            angle: angle(&flow, model.flow, axis(model, wanted.axis)),
            columns: columns_of_user(model),
            wanted,
        }
    }
}

/// The columns that a sample of a scene needs.
pub fn needed_columns(model: &Model) -> Vec<&'static str> {
    let more = channel_bins(model).map_or(&[][..], |_| &MORE_COLUMNS);
    COLUMNS.iter().chain(more).copied().collect()
}

/// The numbers of a particle in these columns.
pub fn numbers(model: &Model) -> usize {
    6 + channel_bins(model).map_or(0, |_| 5)
}

/// The bins of profiles of a scene that has statistics and a wall, or an open axis.
fn channel_bins(model: &Model) -> Option<usize> {
    model.statistics.and_then(|wanted| channel::bins(model, wanted))
}

/// Whether a scene has species that may separate, in a box that stays where it is.
pub fn has_columns(model: &Model) -> bool {
    let stays = !matches!(model.cell.boundaries(), Boundaries::Open | Boundaries::OpenAlongZ);
    model.species.len() > 1 && stays
}

/// Columns in which to look for the segregation of a scene's species: along the axis of its statistics.
pub fn columns(model: &Model) -> SpeciesColumns {
    let (axis, width) = axis_and_width(model);
    SpeciesColumns::new(&model.cell, axis, width, model.species.len())
}

/// The same columns in the axes of the user.
fn columns_of_user(model: &Model) -> SpeciesColumns {
    let ((axis, width), axes) = (axis_and_width(model), model.user_axes());
    SpeciesColumns::new(&axes.cell(&model.cell), axes.axis(axis), width, model.species.len())
}

/// What such columns take, and as many again that are counted in.
pub fn column_bytes(model: &Model) -> Bytes {
    let (axis, width) = axis_and_width(model);
    let columns = SpeciesColumns::bytes(&model.cell, axis, width, model.species.len());
    columns.then(columns.freed())
}

/// The axis of the gradient of a shear flow.
const GRADIENT: usize = 1;

/// The lattice vector of the box of an extension whose coordinate profiles are of: in planar extension it is along z and stays.
const THIRD: usize = 2;

/// The axis of profiles: the one wanted, by default that of the forces or the gradient, where the box has it.
fn axis(model: &Model, wanted: Option<Axis>) -> usize {
    let usual = || model.force_axis().unwrap_or(GRADIENT);
    wanted.map_or_else(|| if model.flow.extension().is_some() { THIRD } else { usual() }, index)
}

/// The azimuth in shear and planar extension, else that to the axis of the flow, or to the one of profiles.
fn angle(flow: &BackgroundFlow, kind: Flow, axis: usize) -> Angle {
    match kind.extension().and_then(Extension::axis) {
        Some(axis) => Angle::Cosine(index(axis)),
        None if *flow == BackgroundFlow::NONE => Angle::Cosine(axis),
        None => Angle::Azimuth,
    }
}

/// The axis of the columns, by default that of the forces or the gradient, and their width.
fn axis_and_width(model: &Model) -> (usize, f64) {
    let axis = axis(model, model.statistics.and_then(|wanted| wanted.axis));
    (axis, COLUMN_WIDTH * model.species.iter().map(|s| s.radius).fold(0.0, f64::max))
}

/// Places at the same fractions of upright edges as they are of the box's lattice vectors, where that is a lattice; of a box
/// along x, y and z the places themselves.
fn in_lattice<'a>(cell: &PeriodicBox, edges: Vector, particles: &'a Particles) -> Cow<'a, [Vector]> {
    if cell.axes().is_none() {
        return Cow::Borrowed(&particles.positions);
    }
    let over = edges / cell.edges();
    particles.positions.iter().map(|&position| cell.lattice_coordinates(position) * over).collect()
}

/// The particles of this rank in a box counted in columns that are empty, which were made for a box of these edges.
pub fn counted(
    (empty, edges): (&SpeciesColumns, Vector),
    (cell, particles): (&PeriodicBox, &Particles),
) -> SpeciesColumns {
    let mut columns = empty.clone();
    for (&position, &species) in in_lattice(cell, edges, particles).iter().zip(&particles.species) {
        columns.add(position, species);
    }
    columns
}

/// About how fast spheres move in a scene relative to the flow: the fastest that a force on one, the repulsion of two or
/// the shear across one makes it.
fn speed(model: &Model) -> f64 {
    let rate = model.flow.as_shear(model.shear_rates().largest());
    let of = |s: &Species| {
        let repulsion = model.repulsion.map_or(0.0, |r| r.strength * s.radius.powi(r.radius_power.into()));
        let force = s.force_on(s.radius, model.gravity).abs().max_element().max(repulsion);
        let torque = s.torque.abs().max_element() / s.radius;
        (force.max(torque) / (model.viscosity * s.radius)).max(rate * s.radius)
    };
    model.species.iter().map(of).fold(0.0, f64::max)
}

fn index(axis: Axis) -> usize {
    match axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    }
}

/// The vectors of a column; none if there is no such column.
pub fn column<'a>(particles: &'a Particles, name: &str) -> &'a [Vector] {
    particles.columns.iter().find(|c| c.name == name).map(|c| bytemuck::cast_slice(&c.values)).unwrap_or_default()
}

fn each_species(sums: &mut [Vectors], species: &[u32], vectors: &[Vector]) {
    for (index, sum) in sums.iter_mut().enumerate() {
        sum.add(species.iter().zip(vectors).filter(|(s, _)| **s as usize == index).map(|(_, &v)| v));
    }
}

impl State for Statistics {
    fn visit(&mut self, store: &mut dyn Store) {
        for number in &mut self.times {
            store.number(number);
        }
        for vectors in self.velocities.iter_mut().chain(&mut self.angular_velocities) {
            vectors.moments.visit(store);
            for density in &mut vectors.densities {
                density.visit(store);
            }
        }
        self.paths.visit(store);
        self.lagrangian.visit(store);
        let parts: [Option<&mut dyn State>; 4] = [
            self.pairs.as_mut().map(|part| part as _),
            self.profile.as_mut().map(|part| part as _),
            self.channel.as_mut().map(|channel| &mut channel.profile as _),
            Some(&mut self.segregation),
        ];
        for part in parts.into_iter().flatten() {
            part.visit(store);
        }
        if let Some(moduli) = &mut self.moduli {
            moduli.visit(store);
        }
        if let Some(pressure) = &mut self.pressure {
            pressure.visit(store);
        }
    }
}

#[cfg(test)]
mod tests;
