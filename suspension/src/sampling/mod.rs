//! Statistics of a suspension, during a run or from its trajectory.

mod background;
mod channel;
mod memory;
mod needed_columns;
mod particle_history;
mod paths;
mod rotations;
mod species_columns;
mod tables;
mod vectors;

use crate::columns::{ANGULAR_VELOCITY, ORIENTATION, VELOCITY};
use crate::model::{Axis, Extension, Flow, Model, MultipoleOrder, ShearRates, Species, StatisticsParameters};
use background::Flows;
use channel::{ChannelSampling, MORE_COLUMNS};
use domain::parallel::MeasuredLoop;
use domain::{
    Boundaries, Comm, DomainView, IdBlocks, Particles, Partition, PeriodicBox, Vector, fold_shared_pairs, sphere,
};
pub use memory::RankCounts;
use needed_columns::{channel_bins, oriented};
pub use needed_columns::{has_profile, needed_columns, needs_pair_moments, numbers};
use particle_history::{Moving, ParticleHistory};
use paths::Paths;
use rayon::prelude::*;
use rotations::Rotations;
use solver::BackgroundFlow;
use species_columns::columns_of_user;
pub use species_columns::{column_bytes, columns, counted, has_columns};
use statistics::{Angle, Blocks, Lagrangian, Moduli, PairDistribution, Profile, SpeciesColumns};
use std::borrow::Cow;
use std::ops::Range;
use vectors::{BlockRows, VectorMoments, map_blocks};

/// Columns that a sample needs.
pub const COLUMNS: [&str; 2] = [VELOCITY, ANGULAR_VELOCITY];

/// All statistics, in the user's axes. Sums over particles are taken over blocks of ids, each on one rank, which also
/// stores the state of its particles. So results do not depend on the number of ranks, and no rank holds more than its
/// share. Everything else is on the first rank.
pub struct Statistics {
    about: SampledModel,
    blocks: IdBlocks,
    /// First time, last time, and number of samples; on every rank.
    times: [f64; 3],
    velocities: Vec<VectorMoments>,
    angular_velocities: Vec<VectorMoments>,
    /// State of each of this rank's blocks.
    kept: Vec<ParticleHistory>,
    /// Pair distribution in a fully periodic box; each rank counts the pairs in its part of space.
    pairs: Option<PairDistribution>,
    /// Profile in a box with one or two walls, or open along z.
    channel: Option<ChannelSampling>,
    segregation: Blocks,
    /// Moduli in an oscillating flow.
    moduli: Option<Moduli>,
    /// Pressure gradient at constant flux.
    pressure: Option<Blocks>,
}

/// Input of a sample.
#[derive(Clone, Copy)]
pub struct Sample<'a> {
    /// Time.
    pub time: f64,
    /// Rate of the flow at that time.
    pub rate: f64,
    /// Box, in the user's axes.
    pub cell: &'a PeriodicBox,
    /// Particles of this rank with the columns [`COLUMNS`], those of orientations if they have some, and if profiles
    /// need them those of stresslets and of pair moments.
    pub particles: &'a Particles,
    /// Partition of the box among ranks.
    pub partition: &'a Partition,
    /// Stress of the whole suspension along the flow, if known.
    pub shear_stress: Option<f64>,
    /// Pressure gradient at constant flux, if known.
    pub pressure_gradient: Option<f64>,
}

/// Properties common to all samples.
struct SampledModel {
    names: Vec<String>,
    /// Radius and volume fraction of each species.
    species: Vec<(f64, f64)>,
    /// Number of particles of each species.
    counts: Vec<u64>,
    /// The flow (at its largest rate, if the rate changes), and the flows at any rate.
    flow: BackgroundFlow,
    flows: Flows,
    /// Whether the flow moves spheres along each axis.
    advects: [bool; 3],
    /// Edges of the unstrained box.
    edges: Vector,
    rates: ShearRates,
    rigid: bool,
    /// Indices and names of the species with orientations.
    oriented: Vec<(usize, String)>,
    /// Whether there is Brownian motion.
    is_brownian: bool,
    axis: usize,
    /// Angle by which the separations of pairs are classified.
    angle: Angle,
    columns: SpeciesColumns,
    wanted: StatisticsParameters,
}

/// Default of the largest pair distance, over the largest radius, unless the box is smaller.
const DISTANCE: f64 = 8.0;
impl Statistics {
    /// Statistics without samples, for a model and each rank's own particles. Collective.
    pub fn new(model: &Model, wanted: StatisticsParameters, particles: &Particles, comm: &Comm) -> Self {
        Self::in_blocks_of(IdBlocks::SIZE, model, wanted, particles, comm)
    }

    /// Statistics with blocks of `size` ids.
    pub(crate) fn in_blocks_of(
        size: u64,
        model: &Model,
        wanted: StatisticsParameters,
        particles: &Particles,
        comm: &Comm,
    ) -> Self {
        let blocks = IdBlocks::of(particles, comm, size);
        let redistributed = blocks.distributed(particles, |_| false);
        let rows = blocks.rows(&redistributed);
        let mut largest = [redistributed.radii.iter().copied().fold(0.0, f64::max)];
        comm.max(&mut largest);
        let parts = BlockRows { blocks: &blocks, rows: &rows };
        let about = SampledModel::of(model, wanted, parts, &redistributed);
        let (speed, [largest]) = (speed(model), largest);
        let each = |size: f64| about.names.iter().map(|_| VectorMoments::about(size)).collect();
        let is_periodic = model.cell.boundaries() == Boundaries::Periodic;
        let distance = distance(model, wanted, largest);
        let pairs = || PairDistribution::new(distance, about.angle, about.counts.clone(), model.cell.volume());
        let profile = || is_periodic.then(|| Profile::new(&model.cell, about.axis, about.names.len()));
        Self {
            times: [f64::NAN, f64::NAN, 0.0],
            velocities: each(speed),
            angular_velocities: each(if largest > 0.0 { speed / largest } else { 1.0 }),
            kept: kept(&redistributed.species, parts, &about, profile),
            pairs: is_periodic.then(pairs),
            channel: ChannelSampling::of(model, wanted),
            segregation: Blocks::default(),
            moduli: about.rates.frequency().map(|w| Moduli::new(about.rates.largest() / w, w)),
            blocks,
            pressure: model.flow.keeps_flux().then(Blocks::default),
            about,
        }
    }

    /// Takes a sample, unless it is before the first time. Samples are equidistant in time, except for those that were
    /// [skipped](Self::skip_missing). Collective.
    pub fn sample(&mut self, sample: &Sample) {
        if sample.time < self.about.wanted.from {
            return;
        }
        self.count_pairs(sample);
        let is_oriented = !self.about.oriented.is_empty();
        let needed = |name: &str| {
            let of_profile = self.channel.is_some() && MORE_COLUMNS.contains(&name);
            COLUMNS.contains(&name) || of_profile || is_oriented && name == ORIENTATION
        };
        let particles = &*self.blocks.distributed(sample.particles, needed);
        let rows = self.blocks.rows(particles);
        let velocities = self.average(sample.rate, particles, &rows);
        self.follow_rotations(sample.time, particles, &rows);
        self.follow(sample, particles, &rows, &velocities);
        let intensity = self.intensity(sample.cell, particles);
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

    /// Passes over missing samples: the next one is as many intervals later.
    pub fn skip_missing(&mut self, missing: u64) {
        for kept in &mut self.kept {
            kept.lagrangian.skip_missing(missing);
            kept.rotations.iter_mut().for_each(|rotations| rotations.skip_missing(missing));
        }
    }

    /// Averages velocities relative to the flow, which it returns, and angular velocities.
    fn average(&mut self, rate: f64, particles: &Particles, rows: &[Range<usize>]) -> Vec<Vector> {
        let (flow, parts) = (self.about.flows.at_rate(rate), BlockRows { blocks: &self.blocks, rows });
        let velocities = column(particles, VELOCITY).iter().zip(particles.positions.iter().zip(&particles.radii));
        let velocities: Vec<Vector> = velocities.map(|(&v, (&x, &a))| v - flow.velocity_of(x, a)).collect();
        VectorMoments::add(&mut self.velocities, parts, &particles.species, &velocities);
        if self.about.rigid {
            let turning = column(particles, ANGULAR_VELOCITY).iter().zip(&particles.positions);
            let turning: Vec<Vector> = turning.map(|(&w, &x)| w - flow.angular_velocity_at(x)).collect();
            VectorMoments::add(&mut self.angular_velocities, parts, &particles.species, &turning);
        }
        if let Some(channel) = &mut self.channel {
            channel.add(parts, particles, &velocities);
        }
        velocities
    }

    /// Updates the state of the particles of each block.
    fn follow(
        &mut self,
        &Sample { time, cell, .. }: &Sample,
        particles: &Particles,
        rows: &[Range<usize>],
        velocities: &[Vector],
    ) {
        let in_lattice = &*in_lattice(cell, self.about.edges, particles);
        let Particles { positions, steps, radii, species, .. } = particles;
        let advects = self.about.advects;
        let moving = Moving { time, cell, positions, steps, velocities, advects, in_lattice, radii, species };
        self.kept.par_iter_mut().zip(rows).measured().for_each(|(kept, rows)| kept.add(&moving, rows.clone()));
    }

    /// Updates the rotations of the particles of each block, if there are orientations.
    fn follow_rotations(&mut self, time: f64, particles: &Particles, rows: &[Range<usize>]) {
        let Some(orientations) = rotations::orientations(particles) else { return };
        let blocks = self.kept.par_iter_mut().zip(rows);
        blocks.for_each(|(kept, rows)| {
            kept.rotations.iter_mut().for_each(|rotations| rotations.add(time, &orientations[rows.clone()]));
        });
    }

    /// Counts pairs, each on the rank whose part of space has the particle with the smaller id.
    fn count_pairs(&mut self, &Sample { cell, particles, partition, .. }: &Sample) {
        let Some(pairs) = &mut self.pairs else { return };
        let mut own = Cow::Borrowed(particles);
        if partition.comm().size() > 1 {
            own = Cow::Owned(particles.without_columns());
            own.to_mut().migrate(partition, cell);
        }
        let count = |found: &mut Vec<u32>, species, separation| pairs.count(found, species, separation);
        let found = fold_shared_pairs(DomainView { cell, partition }, &own, pairs.cutoff(), || pairs.no_pairs(), count);
        pairs.add_counted(found);
    }

    /// Intensity of segregation of the species; 0 for a single species.
    fn intensity(&self, cell: &PeriodicBox, particles: &Particles) -> f64 {
        if self.about.names.len() == 1 {
            return 0.0;
        }
        let mut counted = counted(&self.about.columns, self.about.edges, cell, particles);
        self.blocks.comm().sum(counted.counts());
        counted.intensity()
    }
}

/// Largest pair distance, for a given largest radius.
pub fn distance(model: &Model, wanted: StatisticsParameters, largest: f64) -> f64 {
    wanted.distance.unwrap_or(DISTANCE * largest).min(model.cell.edges().min_element())
}

/// State without samples of the particles of each block.
fn kept(
    species: &[u32],
    BlockRows { blocks, rows }: BlockRows,
    about: &SampledModel,
    profile: impl Fn() -> Option<Profile>,
) -> Vec<ParticleHistory> {
    let numbers = |rows: &Range<usize>| {
        let mut numbers = vec![0; about.names.len()];
        for &species in &species[rows.clone()] {
            numbers[species as usize] += 1;
        }
        numbers
    };
    let before = blocks.before(&rows.iter().map(numbers).collect::<Vec<_>>());
    let of_block = |(before, rows): (Vec<u64>, &Range<usize>)| {
        let species = &species[rows.clone()];
        let rotations = (!about.oriented.is_empty()).then(|| Rotations::after(before.clone(), species));
        let lagrangian = Lagrangian::after(before, species);
        ParticleHistory { paths: Paths::default(), lagrangian, rotations, profile: profile() }
    };
    before.into_iter().zip(rows).map(of_block).collect()
}

impl SampledModel {
    fn of(
        model: &Model,
        wanted: StatisticsParameters,
        BlockRows { blocks, rows }: BlockRows,
        redistributed: &Particles,
    ) -> Self {
        let rates = model.shear_rates();
        let (flows, rate) = (Flows::of(model), if rates.is_constant() { rates.before(0).0 } else { rates.largest() });
        let flow = flows.linear(rate);
        // Number and volume of each species.
        let sums = blocks.total(&map_blocks(rows, |rows| {
            let mut sums = vec![[0.0; 2]; model.species.len()];
            for (&species, a) in redistributed.species[rows.clone()].iter().zip(&redistributed.radii[rows]) {
                let [number, volume] = &mut sums[species as usize];
                *number += 1.0;
                *volume += sphere::volume(*a);
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
            advects: flows.advects(rate),
            flows,
            edges: model.cell.edges(),
            rates,
            rigid: model.hydrodynamics.multipoles == MultipoleOrder::Dipole,
            oriented: oriented(model),
            is_brownian: model.thermal_energy.is_some(),
            axis: axis(model, wanted.axis),
            angle: angle(&flow, model.flow, axis(model, wanted.axis)),
            columns: columns_of_user(model),
            wanted,
        }
    }
}

/// Gradient axis of a shear flow.
const GRADIENT: usize = 1;

/// Lattice vector of the box of an extension along which profiles are taken; in planar extension it is along z and
/// constant.
const THIRD: usize = 2;

/// Axis of profiles: the one that is wanted, or by default that of the forces or the gradient, if the box has it.
fn axis(model: &Model, wanted: Option<Axis>) -> usize {
    let usual = || model.force_axis().unwrap_or(GRADIENT);
    wanted.map_or_else(|| if model.flow.extension().is_some() { THIRD } else { usual() }, index)
}

/// Azimuth in shear and planar extension, otherwise the angle to the axis of the flow, or to that of profiles.
fn angle(flow: &BackgroundFlow, kind: Flow, axis: usize) -> Angle {
    match kind.extension().and_then(Extension::axis) {
        Some(axis) => Angle::Cosine(index(axis)),
        None if *flow == BackgroundFlow::NONE => Angle::Cosine(axis),
        None => Angle::Azimuth,
    }
}

/// Positions mapped from the lattice of the box to one with orthogonal edges, at the same lattice coordinates;
/// unchanged for a box along x, y and z.
fn in_lattice<'a>(cell: &PeriodicBox, edges: Vector, particles: &'a Particles) -> Cow<'a, [Vector]> {
    if cell.axes().is_none() {
        return Cow::Borrowed(&particles.positions);
    }
    let over = edges / cell.edges();
    particles.positions.iter().map(|&position| cell.lattice_coordinates(position) * over).collect()
}

/// Estimated speed of the spheres relative to the flow: the largest due to a force, the repulsion of a pair, the
/// shear across a sphere, or swimming.
fn speed(model: &Model) -> f64 {
    let rate = model.flow.as_shear(model.shear_rates().largest());
    let of = |s: &Species| {
        let repulsion = model.repulsion.map_or(0.0, |r| r.strength * s.radius.powi(r.radius_power.into()));
        let force = s.force_on(s.radius, model.gravity).abs().max_element().max(repulsion);
        let torque = s.torque.abs().max_element() / s.radius;
        let swimming = s.swimming.as_ref().map_or(0.0, |swimming| swimming.speed);
        (force.max(torque) / (model.viscosity * s.radius)).max(rate * s.radius).max(swimming)
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

/// The vectors of a column; empty if there is no such column.
pub fn column<'a>(particles: &'a Particles, name: &str) -> &'a [Vector] {
    particles.columns.iter().find(|c| c.name == name).map(|c| bytemuck::cast_slice(&c.values)).unwrap_or_default()
}

#[cfg(test)]
mod rank_tests;
#[cfg(test)]
mod tests;
