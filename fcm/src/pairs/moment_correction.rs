//! Pair correction of moments: the difference between the fields of points and of the common wide Gaussians.
//!
//! Outside of a uniformly magnetised sphere the field is that of a point, and its average over another sphere is its
//! value in the centre. So that is the field between spheres that do not overlap, and in themselves they have that of
//! their envelopes. With `x` from the source to the target and `psi_n = (1/r d/dr)^n psi` of a potential `psi`, the
//! field of a moment `m` and its gradient are
//!
//! ```text
//! H_a      = d_a d_b psi m_b = psi_1 m_a + psi_2 x_a (x.m)
//! d_c H_a  = psi_2 (x_c m_a + x_a m_c + delta_ac x.m) + psi_3 x_a x_c (x.m)
//! ```

use crate::envelope::Envelope;
use crate::pairs::pair_correction::{DynPairCorrection, LoadedParticles};
use crate::pairs::pair_functions::GaussianPotential;
use crate::pairs::table::{PairTable, PairValues, TabulatedFunctions};
use domain::parallel::{MeasuredLoop, change_rows};
use domain::{Neighbour, Neighbours, Tensor, Vector};
use rayon::prelude::*;
use simd::{SimdVector, VectorKernel};
use solver::Real;
use std::f64::consts::PI;

/// Distance over the sum of the radii below which the functions of overlapping spheres no longer grow: from `2^(-2/3)`
/// on two equal spheres have a positive energy.
const NEAREST: f64 = 0.65;

/// Pair correction of the moments of particles of given radii.
pub(crate) struct MomentCorrection {
    cutoff: f64,
    radii: Vec<f64>,
    /// `psi_1` of a sphere in itself, by class.
    own: Vec<f64>,
    wide: GaussianPotential,
    /// None if it would cost more than it saves.
    table: Option<PairTable<f64>>,
}

/// A moment at a distance `x` from a target, and `psi_1`, `psi_2` and `psi_3` there.
struct NearMoment {
    x: Vector,
    moment: Vector,
    psi: [f64; 3],
}

impl NearMoment {
    #[inline(always)]
    fn field(&self) -> Vector {
        let Self { x, moment, psi: [psi1, psi2, _] } = *self;
        moment * psi1 + x * (psi2 * x.dot(moment))
    }

    /// Gradient of the field; column `c` is the derivative along `c`.
    #[inline(always)]
    fn gradient(&self) -> Tensor {
        let Self { x, moment, psi: [_, psi2, psi3] } = *self;
        let along = x.dot(moment);
        let mut columns = [Vector::ZERO; 3];
        for c in 0..3 {
            columns[c] = (moment * x[c] + x * moment[c]) * psi2 + x * (psi3 * x[c] * along);
            columns[c][c] += psi2 * along;
        }
        let [first, second, third] = columns;
        Tensor::from_cols(first, second, third)
    }
}

impl TabulatedFunctions for GaussianPotential {
    /// `psi_1`, `psi_2` and `psi_3`, and `d psi_n / d(r^2) = psi_(n+1)/2`.
    fn derivative(&self, square: f64, order: usize) -> PairValues {
        let (psi, half) = (self.evaluate(square), 0.5_f64.powi(order as i32));
        let mut values = [0.0; 9];
        for n in 0..3 {
            values[n] = psi[n + 1 + order] * half;
        }
        values
    }
}

impl MomentCorrection {
    /// For spheres with these radii and a common Gaussian of this width. Pairs farther apart than the cutoff are left
    /// out; the table is exact to `tolerance`.
    pub fn new(radii: &[f64], width: f64, cutoff: f64, tolerance: f64) -> Self {
        let wide = GaussianPotential::new(width);
        let in_itself = |&radius: &f64| {
            let narrow = GaussianPotential::new(Envelope::of_sphere(radius).dipole);
            narrow.evaluate(0.0)[1] - wide.evaluate(0.0)[1]
        };
        let (own, table) = (radii.iter().map(in_itself).collect(), PairTable::new(&wide, cutoff, tolerance));
        Self { cutoff, radii: radii.to_vec(), own, wide, table }
    }

    /// Bytes of the table of [`Self::new`].
    pub fn table_bytes(width: f64, cutoff: f64, tolerance: f64) -> f64 {
        PairTable::<f64>::bytes(&GaussianPotential::new(width), cutoff, tolerance).unwrap_or(0.0)
    }

    /// `psi_1`, `psi_2` and `psi_3` of a pair of classes.
    #[inline(always)]
    fn functions(&self, [i, j]: [u32; 2], square: f64) -> [f64; 3] {
        // A closure would be compiled for any processor, without its vectors.
        let [first, second, third, ..] =
            if let Some(table) = &self.table { table.evaluate(square) } else { self.wide.derivative(square, 0) };
        let nearest = NEAREST * (self.radii[i as usize] + self.radii[j as usize]);
        let inverse = 1.0 / square.max(nearest * nearest);
        let point = -inverse * inverse.sqrt() / (4.0 * PI);
        [point - first, -3.0 * point * inverse - second, 15.0 * point * inverse * inverse - third]
    }

    /// The moment of a neighbour of a particle.
    #[inline(always)]
    fn near_moment(&self, present: &LoadedParticles, row: usize, neighbour: Neighbour) -> NearMoment {
        let j = neighbour.row as usize;
        let mut x = present.positions[row] - present.positions[j];
        if neighbour.steps != [0; 3] {
            x -= present.cell.lattice(neighbour.steps.map(i32::from));
        }
        let psi = self.functions([present.classes[row], present.classes[j]], x.length_squared());
        NearMoment { x, moment: present.forces[j], psi }
    }
}

/// Particles whose lists one thread processes at a time.
const BATCH: usize = 64;

/// A batch of particles from row `first` on, whose fields are added to `motions`.
struct MomentBatch<'a> {
    near: &'a MomentCorrection,
    present: &'a LoadedParticles<'a>,
    neighbours: &'a Neighbours,
    gradients: bool,
    first: usize,
    motions: &'a mut [(Vector, Tensor)],
}

impl VectorKernel<f64> for MomentBatch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector<f64>>(self) {
        let Self { near, present, neighbours, gradients, first, motions } = self;
        for (offset, motion) in motions.iter_mut().enumerate() {
            let row = first + offset;
            motion.0 += present.forces[row] * near.own[present.classes[row] as usize];
            for neighbour in neighbours.of(row).iter() {
                let other = near.near_moment(present, row, neighbour);
                motion.0 += other.field();
                if gradients {
                    motion.1 += other.gradient();
                }
            }
        }
    }
}

impl DynPairCorrection for MomentCorrection {
    fn cutoff(&self) -> f64 {
        self.cutoff
    }

    fn add(
        &self,
        present: &LoadedParticles,
        neighbours: &Neighbours,
        gradients: bool,
        motions: &mut [(Vector, Tensor)],
    ) {
        if present.forces.is_empty() {
            return;
        }
        let bytes = 2 * size_of_val(motions) + size_of_val(present.forces) + 4 * neighbours.count();
        motions.par_chunks_mut(BATCH).enumerate().moving(bytes).for_each(|(batch, motions)| {
            let first = batch * BATCH;
            f64::dispatch(MomentBatch { near: self, present, neighbours, gradients, first, motions });
        });
    }

    fn add_first_moments(&self, present: &LoadedParticles, neighbours: &Neighbours, sums: &mut [Tensor]) {
        if present.forces.is_empty() {
            return;
        }
        change_rows(sums, |row, sum| {
            let moment = present.forces[row];
            for neighbour in neighbours.of(row).iter() {
                let near = self.near_moment(present, row, neighbour);
                let (x, half) = (near.x, near.gradient() * moment * -0.5);
                *sum += Tensor::from_cols(half * x.x, half * x.y, half * x.z);
            }
        });
    }
}
