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
use crate::grid::totals::Totals;
use crate::pairs::pair_correction::{DynPairCorrection, LoadedParticles};
use crate::pairs::pair_functions::GaussianPotential;
use crate::pairs::table::{PairTable, PairValues, TabulatedFunctions};
use domain::parallel::MeasuredLoop;
use domain::{Neighbours, NeighboursOf, Tensor, Vector};
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

/// Number of pairs whose fields are computed at a time, one per lane.
const LANES: usize = <f64 as Real>::LANES;

/// Moments at distances `x` from a target, and `psi_1`, `psi_2` and `psi_3` there.
struct PackedMoments {
    x: [[f64; LANES]; 3],
    moments: [[f64; LANES]; 3],
    psi: [[f64; LANES]; 3],
}

/// The same in vectors, with the products that fields and gradients have in common.
struct NearMoments<V> {
    x: [V; 3],
    moment: [V; 3],
    psi1: V,
    /// `psi_2 x.m`
    along: V,
    /// `psi_2 m` and `psi_2 m + psi_3 x (x.m)`
    turned: [V; 3],
    bent: [V; 3],
}

impl<V: SimdVector<f64>> NearMoments<V> {
    #[inline(always)]
    fn of(packed: &PackedMoments) -> Self {
        let [x, moment, [psi1, psi2, psi3]]: [[V; 3]; 3] =
            [vectors(&packed.x), vectors(&packed.moments), vectors(&packed.psi)];
        let product = x[0].mul_add(moment[0], x[1].mul_add(moment[1], x[2].mul(moment[2])));
        let (mut turned, mut bent, excess) = (moment, moment, product.mul(psi3));
        for c in 0..3 {
            turned[c] = moment[c].mul(psi2);
            bent[c] = x[c].mul_add(excess, turned[c]);
        }
        Self { x, moment, psi1, along: product.mul(psi2), turned, bent }
    }

    /// Component of the field.
    #[inline(always)]
    fn field(&self, a: usize) -> V {
        self.moment[a].mul_add(self.psi1, self.x[a].mul(self.along))
    }

    /// Derivative of a component of the field along `c`.
    #[inline(always)]
    fn gradient(&self, a: usize, c: usize) -> V {
        let sum = self.x[a].mul_add(self.bent[c], self.turned[a].mul(self.x[c]));
        if a == c { sum.add(self.along) } else { sum }
    }
}

#[inline(always)]
fn vectors<V: SimdVector<f64>>([a, b, c]: &[[f64; LANES]; 3]) -> [V; 3] {
    const { assert!(V::LANES == LANES) };
    // SAFETY: each list holds a whole vector.
    unsafe { [V::load(a.as_ptr()), V::load(b.as_ptr()), V::load(c.as_ptr())] }
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

    /// `psi_1`, `psi_2` and `psi_3` of the common Gaussian.
    #[inline(always)]
    fn of_common(&self, square: f64) -> [f64; 3] {
        // A closure would be compiled for any processor, without its vectors.
        let [first, second, third, ..] =
            if let Some(table) = &self.table { table.evaluate(square) } else { self.wide.derivative(square, 0) };
        [first, second, third]
    }

    /// Packs the moments of at most as many neighbours of a particle as there are lanes.
    #[inline(always)]
    fn pack(&self, present: &LoadedParticles, row: usize, near: NeighboursOf) -> PackedMoments {
        let zero = [[0.0; LANES]; 3];
        let (mut packed, mut squares) = (PackedMoments { x: zero, moments: zero, psi: zero }, [1.0; LANES]);
        for (lane, neighbour) in near.iter().enumerate() {
            let j = neighbour.row as usize;
            let mut x = present.positions[row] - present.positions[j];
            if neighbour.steps != [0; 3] {
                x -= present.cell.lattice(neighbour.steps.map(i32::from));
            }
            let (square, moment) = (x.length_squared(), present.forces[j]);
            let of_common = self.of_common(square);
            let [own, other] = [row, j].map(|row| self.radii[present.classes[row] as usize]);
            let nearest = NEAREST * (own + other);
            squares[lane] = square.max(nearest * nearest);
            for k in 0..3 {
                (packed.x[k][lane], packed.moments[k][lane], packed.psi[k][lane]) = (x[k], moment[k], of_common[k]);
            }
        }
        for lane in 0..LANES {
            let inverse = 1.0 / squares[lane];
            let mut of_point = -inverse * inverse.sqrt() / (4.0 * PI);
            for (psi, factor) in packed.psi.iter_mut().zip([-3.0, -5.0, 1.0]) {
                psi[lane] = of_point - psi[lane];
                of_point *= inverse * factor;
            }
        }
        packed
    }
}

/// Particles whose lists one thread processes at a time.
const BATCH: usize = 64;

/// A batch of particles from row `first` on.
#[derive(Clone, Copy)]
struct MomentBatch<'a> {
    near: &'a MomentCorrection,
    present: &'a LoadedParticles<'a>,
    neighbours: &'a Neighbours,
    first: usize,
}

impl MomentBatch<'_> {
    /// Sums over the near moments of a row, which a function adds group by group.
    #[inline(always)]
    fn sums<V: SimdVector<f64>>(
        &self,
        offset: usize,
        totals: &mut Totals<f64>,
        add: impl Fn(&mut [V; 12], &NearMoments<V>),
    ) -> [f64; 12] {
        let (row, mut sums) = (self.first + offset, [V::splat(0.0); 12]);
        for near in self.neighbours.of(row).chunks(LANES) {
            add(&mut sums, &NearMoments::of(&self.near.pack(self.present, row, near)));
        }
        totals.of(&sums)
    }
}

/// Adds the fields of a batch, and their gradients if requested.
struct MomentFields<'a> {
    batch: MomentBatch<'a>,
    gradients: bool,
    motions: &'a mut [(Vector, Tensor)],
}

impl VectorKernel<f64> for MomentFields<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector<f64>>(self) {
        let (mut totals, MomentBatch { near, present, first, .. }) = (Totals::default(), self.batch);
        for (offset, motion) in self.motions.iter_mut().enumerate() {
            let sums = self.batch.sums::<V>(
                offset,
                &mut totals,
                #[inline(always)]
                |sums, near| {
                    for a in 0..3 {
                        sums[a] = sums[a].add(near.field(a));
                        for c in 0..if self.gradients { 3 } else { 0 } {
                            sums[3 + 3 * c + a] = sums[3 + 3 * c + a].add(near.gradient(a, c));
                        }
                    }
                },
            );
            let [x, y, z, gradient @ ..] = sums;
            let row = first + offset;
            motion.0 += present.forces[row] * near.own[present.classes[row] as usize] + Vector::new(x, y, z);
            motion.1 += Tensor::from_cols_array(&gradient);
        }
    }
}

/// Adds the first moments of a batch.
struct FirstMoments<'a> {
    batch: MomentBatch<'a>,
    sums: &'a mut [Tensor],
}

impl VectorKernel<f64> for FirstMoments<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector<f64>>(self) {
        let (mut totals, MomentBatch { present, first, .. }) = (Totals::default(), self.batch);
        for (offset, sum) in self.sums.iter_mut().enumerate() {
            let half = present.forces[first + offset] * -0.5;
            let [_, _, _, moments @ ..] = self.batch.sums::<V>(
                offset,
                &mut totals,
                #[inline(always)]
                |sums, near| {
                    for a in 0..3 {
                        let mut force = V::splat(0.0);
                        for c in 0..3 {
                            force = near.gradient(a, c).mul_add(V::splat(half[c]), force);
                        }
                        for b in 0..3 {
                            sums[3 + 3 * b + a] = force.mul_add(near.x[b], sums[3 + 3 * b + a]);
                        }
                    }
                },
            );
            *sum += Tensor::from_cols_array(&moments);
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
            let batch = MomentBatch { near: self, present, neighbours, first: batch * BATCH };
            f64::dispatch(MomentFields { batch, gradients, motions });
        });
    }

    fn add_first_moments(&self, present: &LoadedParticles, neighbours: &Neighbours, sums: &mut [Tensor]) {
        if present.forces.is_empty() {
            return;
        }
        sums.par_chunks_mut(BATCH).enumerate().measured().for_each(|(batch, sums)| {
            let batch = MomentBatch { near: self, present, neighbours, first: batch * BATCH };
            f64::dispatch(FirstMoments { batch, sums });
        });
    }
}
