//! Far field by a matrix of exact sums over all pairs, in a periodic box: for few spheres, for tolerances near
//! round-off, and as a check of the other methods.

mod cholesky;
mod entries;
mod pair_sum;
mod quadrupoles;
mod wave_sum;

use crate::lanczos::{DrawDiagnostics, product};
use crate::mobility::far_field::FarField;
use crate::mobility::loads::{Loads, Motion, Output};
use crate::mobility::noise::{self, COMPONENTS, NoiseRequest, ParticleComponents};
use crate::mobility::work::{Stopwatch, Work};
use crate::plan::Plan;
use domain::parallel::MeasuredLoop;
use domain::{Comm, Particles, Partition, PeriodicBox, Traceless, Units, Vector};
use entries::{LocatedSphere, Shapes, rows_of};
use rayon::prelude::*;
use std::ops::Range;

/// The grand mobility as a matrix, of which each rank has the rows of its own particles.
///
/// Columns are in the order of the particles' ids, whatever the ranks. Forces, torques and minus the stresslets of a
/// particle are next to each other, in an orthonormal basis, so the matrix is symmetric and positive definite. The
/// rows are found anew only if particles have moved.
pub(crate) struct DenseFarField {
    plan: Plan,
    /// The plan in units of length and viscosity that make its own about 1.
    scaled: Plan,
    units: Units,
    comm: Comm,
    placed: Option<Placed>,
    rows: Vec<f64>,
    /// Rows of the Cholesky factor, found when first needed, and the weight that was clipped for it.
    factor: Option<(Vec<f64>, f64)>,
    work: Work,
}

/// Particles of all ranks.
#[derive(PartialEq)]
struct Placed {
    cell: PeriodicBox,
    /// In the order of their ids.
    spheres: Vec<LocatedSphere>,
    ids: Vec<u64>,
    /// Places in that order of the particles of all ranks, one rank after the other, and of this rank's.
    all: Vec<usize>,
    own: Vec<usize>,
}

impl Placed {
    /// Collective.
    fn gather(plan: &Plan, cell: PeriodicBox, particles: &Particles, comm: &Comm) -> Self {
        let gathered = comm.all_gather(&particles.ids);
        let scale = 1.0 / plan.units().length;
        let positions: Vec<Vector> = particles.positions.iter().map(|&x| x * scale).collect();
        let positions = comm.all_gather(bytemuck::cast_slice::<Vector, f64>(&positions));
        let classes: Vec<u32> = particles.radii.iter().map(|&radius| plan.class_of(radius)).collect();
        let classes = comm.all_gather(&classes);
        let mut order: Vec<usize> = (0..gathered.len()).collect();
        order.sort_by_key(|&row| gathered[row]);
        let sphere =
            |&row: &usize| LocatedSphere { position: Vector::from_slice(&positions[3 * row..]), class: classes[row] };
        let ids: Vec<u64> = order.iter().map(|&row| gathered[row]).collect();
        let place = |id: &u64| ids.binary_search(id).expect("every particle was gathered");
        let (all, own) = (gathered.iter().map(place).collect(), particles.ids.iter().map(place).collect());
        Self { cell, spheres: order.iter().map(sphere).collect(), ids, all, own }
    }
}

impl DenseFarField {
    /// Sets up the matrix of a plan.
    pub fn new(plan: &Plan, partition: &Partition) -> Self {
        let units = plan.units();
        Self {
            plan: plan.clone(),
            scaled: plan.in_units(&units),
            units,
            comm: partition.comm().clone(),
            placed: None,
            rows: Vec::new(),
            factor: None,
            work: Work::default(),
        }
    }

    /// Rows of each particle.
    fn height(&self) -> usize {
        self.plan.multipoles.components()
    }

    /// Loads of all particles in the order of their ids, as far as the matrix has columns for them.
    fn gathered(&self, placed: &Placed, loads: &Loads) -> Vec<f64> {
        let over_torque = 1.0 / self.units.torque();
        let own = (0..placed.own.len()).map(|row| {
            let vector = |list: &[Vector]| list.get(row).copied().unwrap_or_default().to_array();
            let [[fx, fy, fz], torque] = [vector(&loads.forces), vector(&loads.torques)];
            let [tx, ty, tz] = torque.map(|t| t * over_torque);
            let stresslet = loads.stresslets.get(row).copied().unwrap_or(Traceless::ZERO);
            let [a, b, c, d, e] = noise::orthonormal(-stresslet).map(|s| s * over_torque);
            [fx, fy, fz, tx, ty, tz, a, b, c, d, e]
        });
        let own: Vec<ParticleComponents> = own.collect();
        let (height, all) = (self.height(), self.comm.all_gather(own.as_flattened()));
        let mut ordered = vec![0.0; placed.all.len() * height];
        for (components, &place) in all.chunks(COMPONENTS).zip(&placed.all) {
            ordered[place * height..][..height].copy_from_slice(&components[..height]);
        }
        ordered
    }

    /// Rows of a matrix times a vector, for the wanted components of each particle.
    fn times(&self, rows: &[f64], vector: &[f64], wanted: Range<usize>) -> Vec<ParticleComponents> {
        let height = self.height();
        let of_particle = |rows: &[f64]| {
            let mut components = ParticleComponents::default();
            for row in wanted.start..wanted.end.min(height) {
                components[row] = product(&rows[row * vector.len()..][..vector.len()], vector);
            }
            components
        };
        rows.par_chunks((height * vector.len()).max(1)).map(of_particle).measured().collect()
    }

    /// Motions from components in internal units.
    fn motion(components: &[ParticleComponents], [velocity, rate]: [f64; 2], output: Output) -> Motion {
        let mut motion = noise::motion(components);
        motion.velocities.iter_mut().for_each(|v| *v *= velocity);
        motion.angular_velocities.iter_mut().for_each(|w| *w *= rate);
        motion.strain_rates.iter_mut().for_each(|e| *e = *e * rate);
        match output {
            Output::All => motion,
            Output::Velocities => Motion { velocities: motion.velocities, ..Motion::default() },
            Output::Gradients => Motion { velocities: Vec::new(), ..motion },
        }
    }

    /// Rows of the Cholesky factor of this rank's particles, and the weight that was clipped for it. Collective.
    fn factor_of(&self, placed: &Placed) -> (Vec<f64>, f64) {
        let (height, size) = (self.height(), placed.ids.len() * self.height());
        let mut matrix = vec![0.0; size * size];
        let length = height * size;
        for (rows, &place) in self.rows.chunks(length.max(1)).zip(&placed.own) {
            matrix[place * length..][..length].copy_from_slice(rows);
        }
        self.comm.sum(&mut matrix);
        let clipped = cholesky::factorise(&mut matrix, size);
        let mut own = Vec::with_capacity(self.rows.len());
        for &place in &placed.own {
            for row in place * height..(place + 1) * height {
                own.extend_from_slice(&matrix[row * size..][..=row]);
                own.resize(own.len() + size - row - 1, 0.0);
            }
        }
        (own, clipped)
    }
}

impl FarField for DenseFarField {
    fn arrange(&mut self, cell: &PeriodicBox, particles: &Particles) {
        let mut clock = Stopwatch::start();
        let scale = 1.0 / self.units.length;
        let placed = Placed::gather(&self.plan, cell.scaled(scale), particles, &self.comm);
        clock.stop(&mut self.work.seconds.exchange);
        if !self.comm.any(self.placed.as_ref() != Some(&placed)) {
            return;
        }
        let shapes = Shapes::new(&self.scaled, &placed.cell, self.height());
        self.factor = None;
        self.rows = Vec::new();
        self.rows = rows_of(&shapes, &placed.cell, &placed.spheres, &placed.own);
        self.placed = Some(placed);
        clock.stop(&mut self.work.seconds.near);
    }

    fn apply(&mut self, loads: &Loads, output: Output) -> Motion {
        let Some(placed) = &self.placed else { return Motion::default() };
        self.work.evaluations += 1;
        let mut clock = Stopwatch::start();
        let loads = self.gathered(placed, loads);
        clock.stop(&mut self.work.seconds.exchange);
        let wanted = match output {
            Output::Velocities => 0..3,
            Output::Gradients => 3..COMPONENTS,
            Output::All => 0..COMPONENTS,
        };
        let components = self.times(&self.rows, &loads, wanted);
        clock.stop(&mut self.work.seconds.near);
        Self::motion(&components, [self.units.velocity(), self.units.rate()], output)
    }

    fn apply_with_quadrupoles(&mut self, loads: &Loads, quadrupoles: &[Vector]) -> Motion {
        let mut motion = self.apply(loads, Output::All);
        let Some(placed) = &self.placed else { return motion };
        self.work.evaluations += 1;
        let mut clock = Stopwatch::start();
        let all = self.comm.all_gather(bytemuck::cast_slice::<Vector, f64>(quadrupoles));
        let mut ordered = vec![Vector::ZERO; placed.all.len()];
        for (h, &place) in all.chunks(3).zip(&placed.all) {
            ordered[place] = Vector::from_slice(h) * self.units.length.powi(-2);
        }
        clock.stop(&mut self.work.seconds.exchange);
        let shapes = Shapes::new(&self.scaled, &placed.cell, self.height());
        let components = quadrupoles::motions(&shapes, &placed.cell, &placed.spheres, &placed.own, &ordered);
        clock.stop(&mut self.work.seconds.near);
        motion.add(1.0, &Self::motion(&components, [self.units.velocity(), self.units.rate()], Output::All));
        motion
    }

    fn noise(&mut self, draw: &NoiseRequest) -> (Motion, DrawDiagnostics) {
        let Some(placed) = &self.placed else { return (Motion::default(), DrawDiagnostics::default()) };
        if self.factor.is_none() {
            self.factor = Some(self.factor_of(placed));
        }
        let Some((factor, clipped)) = &self.factor else { return (Motion::default(), DrawDiagnostics::default()) };
        let height = self.height();
        let numbers: Vec<f64> =
            placed.ids.iter().flat_map(|&id| draw.stream.of_particle(id).into_iter().take(height)).collect();
        let components = self.times(factor, &numbers, 0..COMPONENTS);
        // The variance of a velocity has the unit of the mobility.
        let Units { length, viscosity, .. } = self.units;
        let scales = [length, length.powi(3)].map(|size| (size * viscosity).sqrt().recip());
        let motion = Self::motion(&components, scales, Output::All).of(self.plan.multipoles);
        (motion, DrawDiagnostics { iterations: 1, clipped: *clipped, change: 0.0 })
    }

    fn work(&self) -> Work {
        self.work
    }
}
