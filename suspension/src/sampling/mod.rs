//! Statistics of a suspension, in the course of a run or from its trajectory.

mod background;
mod channel;
mod kept;
mod memory;
mod paths;
mod tables;
mod vectors;

use crate::columns::{ANGULAR_VELOCITY, PAIR_MOMENT_NUMBERS, STRESSLET, VELOCITY};
use crate::model::{Axis, Extension, Flow, Model, Multipoles, Parameters, ShearRates, Species, Statistics as Wanted};
use background::Flows;
use channel::{Channel, MORE_COLUMNS};
use domain::{Boundaries, Bytes, Comm, IdBlocks, Particles, Partition, PeriodicBox, Vector, fold_shared_pairs};
use kept::{Kept, Moving};
pub use memory::OfRank;
use paths::Paths;
use rayon::prelude::*;
use solver::BackgroundFlow;
use statistics::{Angle, Blocks, Lagrangian, Moduli, PairDistribution, Profile, SpeciesColumns};
use std::borrow::Cow;
use std::ops::Range;
use vectors::{Vectors, in_parts};

/// The columns that a sample needs.
pub const COLUMNS: [&str; 2] = [VELOCITY, ANGULAR_VELOCITY];

/// Everything that is averaged, in the axes of the user. Sums over particles are taken block by block of their ids, each on one
/// rank, and what is kept of particles is kept there, so that results do not depend on the number of ranks and none has more than
/// its share. What is of all is on the first rank.
pub struct Statistics {
    about: About,
    blocks: IdBlocks,
    /// First time, last time, and samples; on every rank.
    times: [f64; 3],
    velocities: Vec<Vectors>,
    angular_velocities: Vec<Vectors>,
    /// Of each of this rank's blocks.
    kept: Vec<Kept>,
    /// In a box that repeats along all axes; each rank counts those of its share of space.
    pairs: Option<PairDistribution>,
    /// In one with walls, a wall, or open along z.
    channel: Option<Channel>,
    segregation: Blocks,
    /// In a flow that oscillates.
    moduli: Option<Moduli>,
    /// The pressure gradient, where it keeps the flux.
    pressure: Option<Blocks>,
}

/// What a sample is taken of.
#[derive(Clone, Copy)]
pub struct Sample<'a> {
    /// When.
    pub time: f64,
    /// The rate of the flow then.
    pub rate: f64,
    /// The box, in the axes of the user.
    pub cell: &'a PeriodicBox,
    /// The particles of this rank, with the columns [`COLUMNS`], and of stresslets and of moments of pairs if there are any and profiles need them.
    pub particles: &'a Particles,
    /// Which share of the box each rank has.
    pub partition: &'a Partition,
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
    /// Particles of each.
    counts: Vec<u64>,
    /// The flow, at its largest rate if that changes, and its rates in time.
    flow: BackgroundFlow,
    flows: Flows,
    /// Along which axes the flow carries spheres.
    carries: [bool; 3],
    /// Edges of the box without strain.
    edges: Vector,
    rates: ShearRates,
    rigid: bool,
    /// Whether spheres move by heat.
    has_heat: bool,
    axis: usize,
    /// By which separations of pairs are told apart.
    angle: Angle,
    columns: SpeciesColumns,
    wanted: Wanted,
}

/// The largest distance of pairs, in largest radii, unless the scene says it or the box is smaller.
const DISTANCE: f64 = 8.0;
/// Width of the columns of segregation, in largest radii.
const COLUMN_WIDTH: f64 = 4.0;

impl Statistics {
    /// Nothing so far, for a scene of whose particles each rank brings its own. Collective.
    pub fn new(model: &Model, wanted: Wanted, particles: &Particles, comm: &Comm) -> Self {
        Self::in_blocks_of(IdBlocks::SIZE, (model, wanted), particles, comm)
    }

    /// The same in blocks of so many ids.
    pub(crate) fn in_blocks_of(size: u64, of: (&Model, Wanted), particles: &Particles, comm: &Comm) -> Self {
        let (model, wanted) = of;
        let blocks = IdBlocks::of(particles, comm, size);
        let dealt = blocks.dealt(particles, |_| false);
        let rows = blocks.rows(&dealt);
        let mut largest = [dealt.radii.iter().copied().fold(0.0, f64::max)];
        comm.max(&mut largest);
        let (about, speed, [largest]) = (About::of(of, (&blocks, &rows), &dealt), speed(model), largest);
        let each = |size: f64| about.names.iter().map(|_| Vectors::about(size)).collect();
        let is_periodic = model.cell.boundaries() == Boundaries::Periodic;
        let distance = distance(of, largest);
        let pairs = || PairDistribution::new(distance, about.angle, about.counts.clone(), model.cell.volume());
        let profile = || is_periodic.then(|| Profile::new(&model.cell, about.axis, about.names.len()));
        Self {
            times: [f64::NAN, f64::NAN, 0.0],
            velocities: each(speed),
            angular_velocities: each(if largest > 0.0 { speed / largest } else { 1.0 }),
            kept: kept(&dealt.species, (&blocks, &rows), about.names.len(), profile),
            pairs: is_periodic.then(pairs),
            channel: Channel::of(model, wanted),
            segregation: Blocks::default(),
            moduli: about.rates.frequency().map(|w| Moduli::new(about.rates.largest() / w, w)),
            blocks,
            pressure: model.flow.keeps_flux().then(Blocks::default),
            about,
        }
    }

    /// Takes a sample, unless it is too early for it. Samples are at equal times, but for those that were
    /// [passed over](Self::pass_over). Collective.
    pub fn sample(&mut self, sample: &Sample) {
        if sample.time < self.about.wanted.from {
            return;
        }
        self.count_pairs(sample);
        let needed = |name: &str| COLUMNS.contains(&name) || (self.channel.is_some() && MORE_COLUMNS.contains(&name));
        let particles = &*self.blocks.dealt(sample.particles, needed);
        let rows = self.blocks.rows(particles);
        let velocities = self.average(sample.rate, (particles, &rows));
        self.follow(sample, (particles, &rows), &velocities);
        let intensity = self.intensity((sample.cell, particles));
        if self.blocks.comm().is_first() {
            self.segregation.add(intensity);
            if let (Some(moduli), Some(stress)) = (&mut self.moduli, sample.shear_stress) {
                moduli.add(sample.time, stress);
            }
            if let (Some(pressure), Some(gradient)) = (&mut self.pressure, sample.pressure_gradient) {
                pressure.add(gradient);
            }
        }
        let [first, _, samples] = self.times;
        self.times = [if samples == 0.0 { sample.time } else { first }, sample.time, samples + 1.0];
    }

    /// Passes over so many samples that are missing: the next one is so many intervals later.
    pub fn pass_over(&mut self, missing: u64) {
        self.kept.iter_mut().for_each(|kept| kept.lagrangian.pass_over(missing));
    }

    /// Averages velocities relative to the flow, which it returns, and angular velocities.
    fn average(&mut self, rate: f64, (particles, rows): (&Particles, &[Range<usize>])) -> Vec<Vector> {
        let (flow, parts) = (self.about.flows.at_rate(rate), (&self.blocks, rows));
        let velocities = column(particles, VELOCITY).iter().zip(particles.positions.iter().zip(&particles.radii));
        let velocities: Vec<Vector> = velocities.map(|(&v, (&x, &a))| v - flow.velocity_of(x, a)).collect();
        Vectors::add(&mut self.velocities, parts, &particles.species, &velocities);
        if self.about.rigid {
            let turning = column(particles, ANGULAR_VELOCITY).iter().zip(&particles.positions);
            let turning: Vec<Vector> = turning.map(|(&w, &x)| w - flow.angular_velocity_at(x)).collect();
            Vectors::add(&mut self.angular_velocities, parts, &particles.species, &turning);
        }
        if let Some(channel) = &mut self.channel {
            channel.add(parts, particles, &velocities);
        }
        velocities
    }

    /// Follows the particles of each block.
    fn follow(
        &mut self,
        &Sample { time, cell, .. }: &Sample,
        (particles, rows): (&Particles, &[Range<usize>]),
        velocities: &[Vector],
    ) {
        let in_lattice = &*in_lattice(cell, self.about.edges, particles);
        let Particles { positions, steps, radii, species, .. } = particles;
        let carries = self.about.carries;
        let moving = Moving { time, cell, positions, steps, velocities, carries, in_lattice, radii, species };
        self.kept.par_iter_mut().zip(rows).for_each(|(kept, rows)| kept.add(&moving, rows.clone()));
    }

    /// Counts pairs, each on the rank in whose share of space the particle with the smaller id is.
    fn count_pairs(&mut self, &Sample { cell, particles, partition, .. }: &Sample) {
        let Some(pairs) = &mut self.pairs else { return };
        let mut own = Cow::Borrowed(particles);
        if partition.comm().size() > 1 {
            own = Cow::Owned(particles.without_columns());
            own.to_mut().migrate(partition, cell);
        }
        let count = |found: &mut Vec<u32>, species, separation| pairs.count(found, species, separation);
        let found = fold_shared_pairs((partition, cell), &own, pairs.cutoff(), || pairs.no_pairs(), count);
        pairs.add_counted(found);
    }

    /// How far species are apart; of one there is nothing to be counted.
    fn intensity(&self, (cell, particles): (&PeriodicBox, &Particles)) -> f64 {
        if self.about.names.len() == 1 {
            return 0.0;
        }
        let mut counted = counted((&self.about.columns, self.about.edges), (cell, particles));
        self.blocks.comm().sum(counted.counts());
        counted.intensity()
    }
}

/// The largest distance of pairs among spheres of which the largest has this radius.
pub fn distance((model, wanted): (&Model, Wanted), largest: f64) -> f64 {
    wanted.distance.unwrap_or(DISTANCE * largest).min(model.cell.edges().min_element())
}

/// Nothing yet of the particles of each block.
fn kept(
    species: &[u32],
    (blocks, rows): (&IdBlocks, &[Range<usize>]),
    count: usize,
    profile: impl Fn() -> Option<Profile>,
) -> Vec<Kept> {
    let numbers = |rows: &Range<usize>| {
        let mut numbers = vec![0; count];
        for &species in &species[rows.clone()] {
            numbers[species as usize] += 1;
        }
        numbers
    };
    let before = blocks.before(&rows.iter().map(numbers).collect::<Vec<_>>());
    let of_block = |(before, rows): (Vec<u64>, &Range<usize>)| {
        let lagrangian = Lagrangian::after(before, &species[rows.clone()]);
        Kept { paths: Paths::default(), lagrangian, profile: profile() }
    };
    before.into_iter().zip(rows).map(of_block).collect()
}

impl About {
    fn of((model, wanted): (&Model, Wanted), (blocks, rows): (&IdBlocks, &[Range<usize>]), dealt: &Particles) -> Self {
        let rates = model.shear_rates();
        let (flows, rate) = (Flows::of(model), if rates.is_constant() { rates.before(0).0 } else { rates.largest() });
        let flow = flows.linear(rate);
        // Number and volume of each species.
        let sums = blocks.total(&in_parts(rows, |rows| {
            let mut sums = vec![[0.0; 2]; model.species.len()];
            for (&species, a) in dealt.species[rows.clone()].iter().zip(&dealt.radii[rows]) {
                let [number, volume] = &mut sums[species as usize];
                *number += 1.0;
                *volume += 4.0 / 3.0 * std::f64::consts::PI * a.powi(3);
            }
            sums
        }));
        let (sums, _) = sums.as_chunks::<2>();
        let fractions = sums.iter().map(|[_, volume]| volume / model.cell.volume());
        Self {
            names: model.species.iter().map(|s| s.name.clone()).collect(),
            species: model.species.iter().map(|s| s.radius).zip(fractions).collect(),
            counts: sums.iter().map(|[number, _]| *number as u64).collect(),
            flow,
            carries: flows.carries(rate),
            flows,
            edges: model.cell.edges(),
            rates,
            rigid: model.hydrodynamics.multipoles == Multipoles::Dipole,
            has_heat: model.thermal_energy.is_some(),
            axis: axis(model, wanted.axis),
            angle: angle(&flow, model.flow, axis(model, wanted.axis)),
            columns: columns_of_user(model),
            wanted,
        }
    }
}

/// The columns that a sample of a scene needs of a suspension.
pub fn needed_columns(model: &Model) -> Vec<&'static str> {
    COLUMNS.into_iter().chain(channel_bins(model).map(|_| STRESSLET)).collect()
}

/// Whether a sample of a scene needs the column [`PAIR_MOMENT`] besides.
pub fn needs_pair_moments(model: &Model) -> bool {
    let Parameters { repulsion, attraction, contacts, bonds, .. } = &**model;
    let has_pair_forces = repulsion.is_some() || attraction.is_some() || contacts.is_some() || !bonds.is_empty();
    channel_bins(model).is_some() && has_pair_forces
}

/// The numbers of a particle in all of these.
pub fn numbers(model: &Model) -> usize {
    let pair_moments = if needs_pair_moments(model) { PAIR_MOMENT_NUMBERS } else { 0 };
    6 + channel_bins(model).map_or(0, |_| 5) + pair_moments
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

#[cfg(test)]
mod rank_tests;
#[cfg(test)]
mod tests;
