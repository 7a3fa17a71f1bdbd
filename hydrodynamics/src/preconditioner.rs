//! Preconditioner: solves with the near-field resistance matrix.

use crate::body_projection::BodyProjection;
use crate::pairs::matrix::inverse_block::{Block, Products};
use crate::pairs::matrix::sparse::Padded;
use crate::pairs::search::{NearPairs, Pairs};
use crate::pairs::squeezed::{SpheresOfPairs, SqueezedPairs};
use crate::six_vector::{SixVector, SixVectors, dot};
use crate::unknowns::MotionsWithLoads;
use domain::parallel::{FusedLoops, MeasuredLoop, mapped, mapped_mut, of_rows, stage};
use domain::{Comm, Interrupt};
use fcm::{InnerProducts, Iterate, Limits, Linear, Step, System, conjugate_gradients};
use rayon::prelude::*;
use simd::{SimdVector as Width, VectorKernel};
use solver::Real;

/// The matrix `M_0^-1 + R`, with `M_0` the mobility of single spheres and `R` the resistance of the stiff pairs:
/// resistance to rigid-body motions of particles that interact only through the lubrication of stiff pairs.
///
/// With rigid bodies, motions of spheres are those of bodies, `K Q`, and the matrix is `K^T (M_0^-1 + R) K`. Motions
/// are stored sphere by sphere; of loads only the totals on the bodies matter, and residuals are stored as the loads
/// with these totals that [`BodyProjection::project`] distributes. Loads that the rigidity of the bodies adds have no
/// totals. So loads minus the residual and minus `M_0^-1` times the motions are `R` times the motions plus such loads.
pub struct Preconditioner<'a> {
    comm: Comm,
    near: &'a NearPairs,
    pairs: &'static [Pairs],
    single: &'a [SixVector],
    /// Inverses of the diagonal blocks, without the resistance of squeezed pairs to approach.
    inverse: Vec<Block>,
    /// Pairs whose resistance to approach is not in the diagonal blocks.
    squeezed: Option<SqueezedPairs>,
    bodies: Option<BodyProjection<'a>>,
    /// Relative error of a solve, in the norm of the single-sphere resistances.
    tolerance: f64,
}

/// Motions from which a solve starts, and their residual; the last list is overwritten.
#[derive(Default)]
struct InnerSolve {
    motions: SixVectors,
    residual: SixVectors,
    z: SixVectors,
}

/// Smallest error of a tightened solve, and the factor by which the error is reduced each time.
const LEAST_TOLERANCE: f64 = 1e-10;
const SHARPER: f64 = 1e-2;

/// Number of particles that one thread preconditions at a time.
const BATCH: usize = 256;

/// Largest number of iterations of a solve.
const MOST_ITERATIONS: usize = 2000;

impl<'a> Preconditioner<'a> {
    /// The matrix for near pairs of particles with the given single-sphere resistances.
    pub fn new(comm: &Comm, near: &'a NearPairs, single: &'a [SixVector], tolerance: f64) -> Self {
        let inverse = near.stiff().inverses(single, |_, _| {});
        let (comm, pairs) = (comm.clone(), &[Pairs::Stiff][..]);
        Self { comm, near, pairs, single, inverse, squeezed: None, bodies: None, tolerance }
    }

    /// The same matrix, solved in as many iterations for any gaps, by a preconditioner of its own that includes the
    /// coupling of close pairs, if pairs hold a sphere with more than `least` times its drag. For spheres without
    /// bodies. Collective.
    #[must_use]
    pub fn with_squeezed_pairs(mut self, least: f64) -> Self {
        self.squeezed = SqueezedPairs::among(self.near, self.single, least, &self.comm);
        if let Some(squeezed) = &mut self.squeezed {
            self.inverse = self.near.stiff().inverses(self.single, |row, block| squeezed.remove_from(row, block));
            squeezed.couple(self.near, &self.inverse);
        }
        self
    }

    /// The matrix for spheres of which some are parts of rigid bodies.
    #[must_use]
    pub fn with_bodies(self, bodies: Option<BodyProjection<'a>>) -> Self {
        Self { bodies, ..self }
    }

    /// Replaces motions by the nearest ones in which bodies are rigid. Collective.
    pub fn make_rigid(&self, motions: &mut SixVectors) {
        if let Some(bodies) = &self.bodies {
            bodies.make_rigid(motions);
        }
    }

    /// Replaces loads by those with the same totals on bodies. Collective.
    fn project(&self, loads: &mut SixVectors) {
        if let Some(bodies) = &self.bodies {
            bodies.project(loads);
        }
    }

    /// Approximate motions under a load on each particle, from rest, and the pair loads in these motions. Collective.
    pub fn solve(&mut self, load: impl Fn(usize) -> SixVector + Sync) -> MotionsWithLoads {
        let (mut start, count, limits) = (InnerSolve::default(), self.single.len(), self.limits());
        let InnerSolve { motions, residual, z } = &mut start;
        let mut loops = FusedLoops::default();
        loops.of_rows(&mut motions.0, count, |_| SixVector::default());
        loops.of_rows(&mut residual.0, count, &load);
        loops.of_rows(&mut z.0, count, |_| SixVector::default());
        loops.run();
        self.solve_from(start, load, limits)
    }

    /// [`Self::solve`] under a load on each particle, continued from an earlier solution. Collective.
    pub fn continue_solve(
        &mut self,
        found: MotionsWithLoads,
        load: impl Fn(usize) -> SixVector + Sync,
    ) -> MotionsWithLoads {
        let MotionsWithLoads { motions, loads: resisted } = found;
        let (count, single, limits) = (motions.0.len(), self.single, self.limits());
        let mut start = InnerSolve { motions, ..InnerSolve::default() };
        let InnerSolve { motions, residual, z } = &mut start;
        let mut loops = FusedLoops::default();
        loops.of_rows(&mut residual.0, count, |row| load(row) - resisted.0[row] - single[row] * motions.0[row]);
        loops.of_rows(&mut z.0, count, |_| SixVector::default());
        loops.run();
        self.solve_from(start, load, limits)
    }

    /// Motions under the given loads with stiff and soft pairs, to an error of `tolerance`, and the pair loads in these
    /// motions. Starts from `motions`. Collective.
    pub fn solve_with_all(&mut self, mut motions: SixVectors, loads: &SixVectors, tolerance: f64) -> MotionsWithLoads {
        self.pairs = &[Pairs::Stiff, Pairs::Soft];
        self.make_rigid(&mut motions);
        let (count, image) = (motions.0.len(), self.apply(&motions));
        let mut start = InnerSolve { motions, ..InnerSolve::default() };
        let InnerSolve { residual, z, .. } = &mut start;
        let mut loops = FusedLoops::default();
        loops.of_rows(&mut residual.0, count, |row| loads.0[row] - image.0[row]);
        loops.of_rows(&mut z.0, count, |_| SixVector::default());
        loops.run();
        let limits = Limits { tolerance, ..self.limits() };
        drop(image);
        let solved = self.solve_from(start, |row| loads.0[row], limits);
        self.pairs = &[Pairs::Stiff];
        solved
    }

    /// Solves for the motions under a load on each particle, to a tolerance.
    fn solve_from(
        &mut self,
        start: InnerSolve,
        load: impl Fn(usize) -> SixVector + Sync,
        limits: Limits,
    ) -> MotionsWithLoads {
        let _stage = stage("preconditioner");
        let (comm, single) = (self.comm.clone(), self.single);
        let InnerSolve { mut motions, mut residual, mut z } = start;
        self.project(&mut residual);
        conjugate_gradients(&comm, self, Iterate { x: &mut motions, residual: &mut residual, z: &mut z }, limits);
        drop(z);
        let part = |row: usize| load(row) - residual.0[row] - single[row] * motions.0[row];
        let loads = SixVectors(of_rows(motions.0.len(), part));
        MotionsWithLoads { motions, loads }
    }

    fn limits(&self) -> Limits<'static> {
        Limits { tolerance: self.tolerance, iterations: MOST_ITERATIONS, interrupt: &Interrupt::NEVER }
    }

    /// Tightens the tolerance of solves to `tolerance`. Returns whether that is tighter than before.
    pub fn tighten_to(&mut self, tolerance: f64) -> bool {
        let is_less = tolerance < self.tolerance;
        if is_less {
            self.tolerance = tolerance.max(LEAST_TOLERANCE);
        }
        is_less
    }

    /// Tightens the tolerance of solves; `false` if it is the tightest possible already.
    pub fn refine_preconditioner(&mut self) -> bool {
        let can = self.tolerance > LEAST_TOLERANCE;
        self.tolerance = (self.tolerance * SHARPER).max(LEAST_TOLERANCE);
        can
    }
}

impl System for Preconditioner<'_> {
    type Unknowns = SixVectors;
    type Residual = SixVectors;

    fn product(&self, residual: &SixVectors, x: &SixVectors) -> f64 {
        residual.dot(x)
    }

    fn apply(&mut self, direction: &SixVectors) -> SixVectors {
        self.curvature(direction).0
    }

    fn curvature(&mut self, direction: &SixVectors) -> (SixVectors, f64) {
        self.curvature_of(direction, mapped(&direction.0, Padded::of))
    }

    fn turn(&mut self, direction: &mut SixVectors, factor: f64, z: &SixVectors) -> (SixVectors, f64) {
        let present = mapped_mut(&mut direction.0, |row, motion| {
            (0..6).for_each(|k| motion.0[k] = z.0[row].0[k] + factor * motion.0[k]);
            Padded::of(&*motion)
        });
        self.curvature_of(direction, present)
    }

    fn on_step(&mut self, _: f64) {}

    fn precondition(&mut self, residual: &SixVectors) -> SixVectors {
        let mut motions = SixVectors::zero(residual.0.len());
        let chunks =
            self.inverse.par_chunks(BATCH).zip(residual.0.par_chunks(BATCH)).zip(motions.0.par_chunks_mut(BATCH));
        chunks.measured().for_each(|((blocks, vectors), results)| f64::dispatch(Products { blocks, vectors, results }));
        if let Some(squeezed) = &self.squeezed {
            let spheres = SpheresOfPairs { near: self.near, comm: &self.comm, inverse: &self.inverse };
            squeezed.correct(spheres, &mut motions);
        }
        if let Some(bodies) = &self.bodies {
            bodies.precondition(residual, &mut motions);
        }
        motions
    }

    fn error(&self, residual: &SixVectors, _: &SixVectors) -> f64 {
        error(&residual.0, self.single)
    }

    fn size(&self, x: &SixVectors) -> f64 {
        size(&x.0, self.single)
    }

    fn step_and_measure(
        &mut self,
        at: Iterate<SixVectors, SixVectors>,
        step: Option<Step<SixVectors, SixVectors>>,
    ) -> InnerProducts {
        if self.bodies.is_some() || self.squeezed.is_some() {
            return self.separate_step(at, step);
        }
        let Iterate { x, residual, z } = at;
        let places = x.0.par_chunks_mut(BATCH).zip(residual.0.par_chunks_mut(BATCH)).zip(z.0.par_chunks_mut(BATCH));
        let given = self.inverse.par_chunks(BATCH).zip(self.single.par_chunks(BATCH));
        let of_batch = |(batch, (((x, residual), z), (blocks, single))): (usize, (BatchUnknowns, Given))| {
            let from = batch * BATCH;
            let step = step.as_ref().map(|step| (step.length, [&step.direction.0[from..], &step.image.0[from..]]));
            f64::dispatch(StepAndMeasure { blocks, single, step, x, residual, z })
        };
        let sums: Vec<InnerProducts> = places.zip(given).enumerate().map(of_batch).measured().collect();
        sums.into_iter().fold(InnerProducts::default(), |all, of_batch| all + of_batch)
    }
}

impl Preconditioner<'_> {
    /// [`System::curvature`] of motions that are given twice.
    fn curvature_of(&self, direction: &SixVectors, present: Vec<Padded>) -> (SixVectors, f64) {
        let (mut image, curvature) = self.near.times_present(self.pairs, present, |first, loads| {
            let of_rows = loads.iter_mut().zip(&self.single[first..]).zip(&direction.0[first..]);
            let mut sums = [0.0; 6];
            for ((load, single), motion) in of_rows {
                for k in 0..6 {
                    load.0[k] += single.0[k] * motion.0[k];
                    sums[k] += load.0[k] * motion.0[k];
                }
            }
            sums.iter().sum()
        });
        self.project(&mut image);
        (image, curvature)
    }

    /// [`System::step_and_measure`] with rigid bodies or squeezed pairs.
    fn separate_step(
        &mut self,
        Iterate { x, residual, z }: Iterate<SixVectors, SixVectors>,
        step: Option<Step<SixVectors, SixVectors>>,
    ) -> InnerProducts {
        let mut former = 0.0;
        if let Some(Step { length, direction, image }) = step {
            x.add(length, direction);
            residual.add(-length, &image);
            former = residual.dot(z);
        }
        *z = self.precondition(residual);
        InnerProducts { product: residual.dot(z), former, error: self.error(residual, z), size: self.size(x) }
    }
}

/// Motions, residuals and preconditioned residuals of a batch of particles.
type BatchUnknowns<'a> = ((&'a mut [SixVector], &'a mut [SixVector]), &'a mut [SixVector]);

/// Preconditioner blocks and single-sphere resistances of a batch of particles.
type Given<'a> = (&'a [Block], &'a [SixVector]);

/// [`System::step_and_measure`] for a batch of particles.
struct StepAndMeasure<'a> {
    blocks: &'a [Block],
    single: &'a [SixVector],
    /// Length of a step, its direction and the image of the direction.
    step: Option<(f64, [&'a [SixVector]; 2])>,
    x: &'a mut [SixVector],
    residual: &'a mut [SixVector],
    z: &'a mut [SixVector],
}

impl VectorKernel<f64> for StepAndMeasure<'_> {
    type Output = InnerProducts;

    #[inline(always)]
    fn run<V: Width<f64>>(self) -> InnerProducts {
        let Self { blocks, single, step, x, residual, z } = self;
        let mut former = 0.0;
        if let Some((length, [direction, image])) = step {
            add(x, length, direction);
            add(residual, -length, image);
            former = dot(residual, z);
        }
        Products { blocks, vectors: residual, results: z }.run::<V>();
        InnerProducts { product: dot(residual, z), former, error: error(residual, single), size: size(x, single) }
    }
}

#[inline(always)]
fn add(vectors: &mut [SixVector], factor: f64, others: &[SixVector]) {
    for (a, b) in vectors.iter_mut().zip(others) {
        (0..6).for_each(|k| a.0[k] += factor * b.0[k]);
    }
}

/// Squared norm of the error estimate: the motions of single spheres under the residual. The energy norm would be
/// dominated by stiff pairs, whose loads on the far field converge much later than their motions.
#[inline(always)]
fn error(residual: &[SixVector], single: &[SixVector]) -> f64 {
    squares(residual, single, |load, single| load * load / single)
}

/// Squared norm of motions, weighted by the single-sphere resistances.
#[inline(always)]
fn size(motions: &[SixVector], single: &[SixVector]) -> f64 {
    squares(motions, single, |motion, single| motion * motion * single)
}

#[inline(always)]
fn squares(vectors: &[SixVector], single: &[SixVector], square: impl Fn(f64, f64) -> f64) -> f64 {
    let mut sums = [0.0; 6];
    for (vector, single) in vectors.iter().zip(single) {
        (0..6).for_each(|k| sums[k] += square(vector.0[k], single.0[k]));
    }
    sums.iter().sum()
}
