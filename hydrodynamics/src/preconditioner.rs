//! Preconditioner: solves with the near-field resistance matrix.

use crate::body_projection::BodyProjection;
use crate::pairs::matrix::inverse_block::{Block, Products};
use crate::pairs::search::{NearPairs, Pairs};
use crate::six_vector::{SixVector, SixVectors, dot};
use domain::parallel::{MeasuredLoop, stage};
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
    /// Inverses of the diagonal blocks.
    inverse: Vec<Block>,
    bodies: Option<BodyProjection<'a>>,
    /// Relative error of a solve, in the norm of the single-sphere resistances.
    tolerance: f64,
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
        let inverse = near.stiff().inverses(single);
        Self { comm: comm.clone(), near, pairs: &[Pairs::Stiff], single, inverse, bodies: None, tolerance }
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

    /// Approximate motions under the given loads, and the pair loads in these motions. Collective.
    pub fn solve(&mut self, loads: &SixVectors) -> [SixVectors; 2] {
        let limits = self.limits();
        self.solve_from(SixVectors::zero(loads.0.len()), loads, loads.clone(), limits)
    }

    /// [`Self::solve`], continued from an earlier solution. Collective.
    pub fn continue_solve(&mut self, [motions, resisted]: [SixVectors; 2], loads: &SixVectors) -> [SixVectors; 2] {
        let residual = self.remainder(loads, &resisted, &motions);
        let limits = self.limits();
        self.solve_from(motions, loads, residual, limits)
    }

    /// Motions under the given loads with stiff and soft pairs, to an error of `tolerance`, and the pair loads in these
    /// motions. Starts from `motions`. Collective.
    pub fn solve_with_all(&mut self, mut motions: SixVectors, loads: &SixVectors, tolerance: f64) -> [SixVectors; 2] {
        self.pairs = &[Pairs::Stiff, Pairs::Soft];
        self.make_rigid(&mut motions);
        let mut residual = loads.clone();
        residual.add(-1.0, &self.apply(&motions));
        let limits = Limits { tolerance, ..self.limits() };
        let solved = self.solve_from(motions, loads, residual, limits);
        self.pairs = &[Pairs::Stiff];
        solved
    }

    /// [`Self::solve`] from motions with a known residual.
    fn solve_from(
        &mut self,
        mut motions: SixVectors,
        loads: &SixVectors,
        mut residual: SixVectors,
        limits: Limits,
    ) -> [SixVectors; 2] {
        let _stage = stage("preconditioner");
        let comm = self.comm.clone();
        self.project(&mut residual);
        let mut z = SixVectors::zero(loads.0.len());
        conjugate_gradients(&comm, self, Iterate { x: &mut motions, residual: &mut residual, z: &mut z }, limits);
        let resisted = self.remainder(loads, &residual, &motions);
        [motions, resisted]
    }

    /// Loads minus a part of them and minus the single-sphere resistance to motions.
    fn remainder(&self, loads: &SixVectors, part: &SixVectors, motions: &SixVectors) -> SixVectors {
        let less = |((load, part), (single, motion)): ((&SixVector, &SixVector), (&SixVector, &SixVector))| {
            SixVector(std::array::from_fn(|k| load.0[k] - part.0[k] - single.0[k] * motion.0[k]))
        };
        let of_single = self.single.par_iter().zip(&motions.0);
        let loads = loads.0.par_iter().with_min_len(BATCH).zip(&part.0);
        SixVectors(loads.zip(of_single).map(less).measured().collect())
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
        let (mut image, curvature) = self.near.times_and(self.pairs, direction, |first, loads| {
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

    fn on_step(&mut self, _: f64) {}

    fn precondition(&mut self, residual: &SixVectors) -> SixVectors {
        let mut motions = SixVectors::zero(residual.0.len());
        let chunks =
            self.inverse.par_chunks(BATCH).zip(residual.0.par_chunks(BATCH)).zip(motions.0.par_chunks_mut(BATCH));
        chunks.measured().for_each(|((blocks, vectors), results)| f64::dispatch(Products { blocks, vectors, results }));
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
        if self.bodies.is_some() {
            return self.step_of_bodies(at, step);
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
    /// [`System::step_and_measure`] with rigid bodies.
    fn step_of_bodies(
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
