//! Pair correction: the difference between the envelopes' flow and that of the common wide Gaussians.
//!
//! Between envelopes whose radial function is `B`, with `x` from the source to the target and `f_n = (1/r d/dr)^n B`,
//! the flow of a force `F` and a dipole `G` is (`mu = 1`)
//!
//! ```text
//! u_a       = T_ab F_b + d_c T_ab G_bc,     T_ab = -delta_ab lap B + d_a d_b B
//! T_ab      = -delta_ab (2 f_1 + r^2 f_2) + x_a x_b f_2
//! d_c T_ab  = -delta_ab x_c (4 f_2 + r^2 f_3) + (delta_ac x_b + delta_bc x_a) f_2 + x_a x_b x_c f_3
//! ```
//!
//! and its gradient follows by one more derivative.

use crate::envelope::{Common, Envelope};
use crate::grid::totals::Totals;
use crate::pairs::radial_functions::{Envelopes, MOST_TABULATED, RadialFunctions};
use crate::pairs::table::{PairFunctions, PairTable};
use domain::parallel::{FusedLoops, MeasuredLoop};
use domain::{Neighbours, PeriodicBox, Tensor, Vector};
use rayon::prelude::*;
use simd::{SimdVector as Lanes, StridedRows, VectorKernel};
use solver::{AlignedMemory, Real};
use std::sync::{Mutex, PoisonError};

/// Number of values that describe a pair, or a load: a multiple of the lanes of any vector.
pub(crate) const RECORD: usize = 16;

/// Positions, classes of radius and loads of the particles present; an empty list of forces or dipoles stands for
/// none.
pub(crate) struct LoadedParticles<'a> {
    pub cell: &'a PeriodicBox,
    pub positions: &'a [Vector],
    pub classes: &'a [u32],
    pub forces: &'a [Vector],
    pub dipoles: &'a [Tensor],
}

/// Pair correction in the precision that the plan chose.
pub(crate) trait DynPairCorrection {
    /// Distance beyond which pairs are left out.
    fn cutoff(&self) -> f64;

    /// Adds the near field of all particles present, including the self-term, to the velocities and, if requested,
    /// the velocity gradients of the particles that have neighbour lists.
    fn add(
        &self,
        present: &LoadedParticles,
        neighbours: &Neighbours,
        gradients: bool,
        motions: &mut [(Vector, Tensor)],
    );

    /// Adds the parts of pairs of [`crate::DipoleField::first_moments`]; nothing for other loads than moments.
    fn add_first_moments(&self, _present: &LoadedParticles, _neighbours: &Neighbours, _sums: &mut [Tensor]) {}
}

/// Pair correction of particles of given radii.
pub(crate) struct PairCorrection<T> {
    cutoff: f64,
    inverse_viscosity: f64,
    functions: RadialFunctions<T>,
    /// Memory of the loads, from one evaluation to the next.
    loads: Mutex<Vec<[T; RECORD]>>,
}

impl<T: Real> PairCorrection<T> {
    /// For particles with these envelopes in a fluid of the given viscosity. Pairs farther apart than the cutoff are
    /// left out; tables are exact to `tolerance`.
    pub fn new(envelopes: Envelopes, cutoff: f64, viscosity: f64, tolerance: f64) -> Self {
        let functions = RadialFunctions::new(envelopes, cutoff, tolerance);
        Self { cutoff, inverse_viscosity: 1.0 / viscosity, functions, loads: Mutex::default() }
    }

    /// Bytes of the tables of [`Self::new`].
    pub fn table_bytes(envelopes: &[Envelope], common: Common, cutoff: f64, tolerance: f64) -> f64 {
        if envelopes.len() > MOST_TABULATED {
            return 0.0;
        }
        let bytes = |functions: PairFunctions| PairTable::<T>::bytes(&functions, cutoff, tolerance);
        let pairs = envelopes.iter().flat_map(|&i| envelopes.iter().map(move |&j| PairFunctions::new(i, j, common)));
        pairs.map(bytes).sum::<Option<f64>>().unwrap_or(0.0)
    }

    fn of_itself(&self, present: &LoadedParticles, row: usize) -> (Vector, Tensor) {
        let f = self.functions.of_one(present.classes[row]);
        let velocity = present.forces.get(row).map_or(Vector::ZERO, |&force| force * (-2.0 * f[0]));
        let gradient = present.dipoles.get(row).map_or(Tensor::ZERO, |g| g.transpose() * f[6] - *g * (4.0 * f[6]));
        (velocity, gradient)
    }
}

/// Particles whose lists one thread processes at a time.
const BATCH: usize = 64;

impl<T: Real> DynPairCorrection for PairCorrection<T> {
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
        let mut loads = self.loads.lock().unwrap_or_else(PoisonError::into_inner);
        let mut loops = FusedLoops::default();
        loops.of_rows(&mut *loads, present.positions.len(), |row| load(present, row));
        loops.run();
        let bytes = 2 * size_of_val(motions) + size_of_val(&loads[..]) + 4 * neighbours.count();
        let loads = &loads[..];
        motions.par_chunks_mut(BATCH).enumerate().moving(bytes).for_each(|(batch, motions)| {
            T::dispatch(TargetBatch {
                near: self,
                present,
                loads,
                neighbours,
                gradients,
                first: batch * BATCH,
                motions,
            });
        });
    }
}

/// Force and dipole of a particle as a record: the force, then the dipole row by row.
fn load<T: Real>(present: &LoadedParticles, row: usize) -> [T; RECORD] {
    let mut record = [T::default(); RECORD];
    let force = present.forces.get(row).copied().unwrap_or_default();
    let dipole = present.dipoles.get(row).copied().unwrap_or(Tensor::ZERO);
    for a in 0..3 {
        record[a] = T::from_f64(force[a]);
        for b in 0..3 {
            record[3 + 3 * a + b] = T::from_f64(dipole.col(b)[a]);
        }
    }
    record
}

/// A batch of particles and their neighbour lists.
struct TargetBatch<'a, T> {
    near: &'a PairCorrection<T>,
    present: &'a LoadedParticles<'a>,
    loads: &'a [[T; RECORD]],
    neighbours: &'a Neighbours,
    gradients: bool,
    first: usize,
    motions: &'a mut [(Vector, Tensor)],
}

impl<T: Real> VectorKernel<T> for TargetBatch<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let mut scratch = PairScratch { group: PairGroup::new(), totals: Totals::default() };
        for offset in 0..self.motions.len() {
            let row = self.first + offset;
            // Most lists of a moderately dense suspension fit half a vector.
            let sums = if self.neighbours.of(row).len() <= V::Half::LANES {
                self.sums::<V::Half>(&mut scratch, row)
            } else {
                self.sums::<V>(&mut scratch, row)
            };
            let column = |d: usize| Vector::new(sums[3 + d].to_f64(), sums[6 + d].to_f64(), sums[9 + d].to_f64());
            let velocity = Vector::new(sums[0].to_f64(), sums[1].to_f64(), sums[2].to_f64());
            let gradient = Tensor::from_cols(column(0), column(1), column(2));
            let (own_velocity, own_gradient) = self.near.of_itself(self.present, row);
            let motion = &mut self.motions[offset];
            motion.0 += (velocity + own_velocity) * self.near.inverse_viscosity;
            motion.1 += (gradient + own_gradient) * self.near.inverse_viscosity;
        }
    }
}

struct PairScratch<T: Real> {
    group: PairGroup<T>,
    totals: Totals<T>,
}

impl<T: Real> TargetBatch<'_, T> {
    /// Sums over a particle's neighbours, group by group: its velocity, and its gradient row by row.
    #[inline(always)]
    fn sums<V: Lanes<T>>(&self, PairScratch { group, totals }: &mut PairScratch<T>, row: usize) -> [T; 12] {
        let mut sums = [V::splat(T::default()); 12];
        for near in self.neighbours.of(row).chunks(V::LANES) {
            for (lane, neighbour) in near.iter().enumerate() {
                let j = neighbour.row as usize;
                let mut x = self.present.positions[row] - self.present.positions[j];
                if neighbour.steps != [0; 3] {
                    x -= self.present.cell.lattice(neighbour.steps.map(i32::from));
                }
                let [i, k] = [self.present.classes[row], self.present.classes[j]];
                group.set(lane, x, &self.near.functions.of_pair(i, k, x.length_squared()), &self.loads[j]);
            }
            group.clear::<V>(near.len());
            group.transpose::<V>();
            match (self.gradients, self.present.dipoles.is_empty()) {
                (false, _) => group.add_velocity(&mut sums),
                (true, true) => group.add_by_forces(&mut sums),
                (true, false) => group.add_all(&mut sums),
            }
        }
        totals.of(&sums)
    }
}

/// As many pairs as a vector has lanes: the record of each pair, `x` and the pair functions, and that of its
/// neighbour's load; then the transpose of both, with the lanes of each value contiguous.
struct PairGroup<T> {
    pairs: AlignedMemory<T>,
    loads: AlignedMemory<T>,
    turned: [AlignedMemory<T>; 2],
}

/// Positions in a pair's record of the last of its functions, and of the first eight.
const NINTH: usize = 3;
const FIRST: usize = 4;

impl<T: Real> PairGroup<T> {
    fn new() -> Self {
        let zero = || AlignedMemory::zero(RECORD * T::LANES);
        Self { pairs: zero(), loads: zero(), turned: [zero(), zero()] }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, x: Vector, functions: &[T; 9], load: &[T; RECORD]) {
        let record = &mut self.pairs.values_mut().as_chunks_mut::<RECORD>().0[lane];
        for a in 0..3 {
            record[a] = T::from_f64(x[a]);
        }
        record[NINTH] = functions[8];
        record[FIRST..FIRST + 8].copy_from_slice(&functions[..8]);
        self.loads.values_mut().as_chunks_mut::<RECORD>().0[lane] = *load;
    }

    /// Clears the lanes from `from` on, which have no pair: with functions of zero they add nothing.
    #[inline(always)]
    fn clear<V: Lanes<T>>(&mut self, from: usize) {
        for record in &mut self.pairs.values_mut().as_chunks_mut::<RECORD>().0[from..V::LANES] {
            *record = [T::default(); RECORD];
        }
    }

    #[inline(always)]
    fn transpose<V: Lanes<T>>(&mut self) {
        let [pairs, loads] = &mut self.turned;
        for (from, to) in [(&self.pairs, pairs), (&self.loads, loads)] {
            for first in (0..RECORD).step_by(V::LANES) {
                let (from, to) = (&from.values()[first..], &mut to.values_mut()[first * V::LANES..]);
                // SAFETY: there are as many records as lanes, and room for as many vectors as a record has values.
                unsafe {
                    V::transpose(
                        StridedRows { first: from.as_ptr(), stride: RECORD },
                        StridedRows { first: to.as_mut_ptr(), stride: V::LANES },
                    );
                }
            }
        }
    }

    #[inline(always)]
    fn vector<V: Lanes<T>>(values: &AlignedMemory<T>, value: usize) -> V {
        // SAFETY: there is a vector of each value.
        unsafe { V::load(values.values()[value * V::LANES..(value + 1) * V::LANES].as_ptr()) }
    }

    #[inline(always)]
    fn x<V: Lanes<T>>(&self) -> [V; 3] {
        [Self::vector(&self.turned[0], 0), Self::vector(&self.turned[0], 1), Self::vector(&self.turned[0], 2)]
    }

    /// Pair functions, in the order of [`PairFunctions`].
    #[inline(always)]
    fn functions<V: Lanes<T>>(&self) -> [V; 9] {
        let mut functions = [Self::vector(&self.turned[0], NINTH); 9];
        for f in 0..8 {
            functions[f] = Self::vector(&self.turned[0], FIRST + f);
        }
        functions
    }

    #[inline(always)]
    fn force<V: Lanes<T>>(&self) -> [V; 3] {
        [Self::vector(&self.turned[1], 0), Self::vector(&self.turned[1], 1), Self::vector(&self.turned[1], 2)]
    }

    #[inline(always)]
    fn dipole<V: Lanes<T>>(&self) -> [[V; 3]; 3] {
        let mut g = [[V::splat(T::default()); 3]; 3];
        for a in 0..3 {
            for b in 0..3 {
                g[a][b] = Self::vector(&self.turned[1], 3 + 3 * a + b);
            }
        }
        g
    }

    /// Velocities by forces: adds to the first three sums.
    #[inline(always)]
    fn add_velocity<V: Lanes<T>>(&self, sums: &mut [V; 12]) {
        let (x, force, f) = (self.x::<V>(), self.force::<V>(), self.functions::<V>());
        let (square, along) = (dot(x, x), dot(x, force));
        let level = less(square, f[1], 2.0, f[0]);
        let across = along.mul(f[1]);
        for a in 0..3 {
            sums[a] = force[a].mul_add(level, x[a].mul_add(across, sums[a]));
        }
    }

    /// [`Self::add_all`] without dipoles.
    #[inline(always)]
    fn add_by_forces<V: Lanes<T>>(&self, sums: &mut [V; 12]) {
        self.add_velocity(sums);
        let (x, force, f) = (self.x::<V>(), self.force::<V>(), self.functions::<V>());
        let (square, along) = (dot(x, x), dot(x, force));
        let (level, across, trace) = (less(square, f[5], 4.0, f[4]), along.mul(f[5]), along.mul(f[4]));
        let (mut left, mut right) = (x, x);
        for a in 0..3 {
            left[a] = x[a].mul_add(across, force[a].mul(level));
            right[a] = force[a].mul(f[4]);
        }
        for a in 0..3 {
            for d in 0..3 {
                let sum = left[a].mul_add(x[d], x[a].mul_add(right[d], sums[3 + 3 * a + d]));
                sums[3 + 3 * a + d] = if a == d { sum.add(trace) } else { sum };
            }
        }
    }

    /// Velocities and gradients `d_d u_a` by forces and dipoles. The gradients are the sums from the fourth on, row
    /// by row.
    #[inline(always)]
    fn add_all<V: Lanes<T>>(&self, sums: &mut [V; 12]) {
        self.add_velocity(sums);
        let (x, force, g, f) = (self.x::<V>(), self.force::<V>(), self.dipole::<V>(), self.functions::<V>());
        let (square, along) = (dot(x, x), dot(x, force));
        let (mut gx, mut xg) = (x, x);
        for a in 0..3 {
            gx[a] = dot(g[a], x);
            xg[a] = dot([g[0][a], g[1][a], g[2][a]], x);
        }
        let xgx = dot(x, gx);
        // From the dipole to the velocity.
        let level = less(square, f[3], 4.0, f[2]);
        let across = xgx.mul(f[3]);
        for a in 0..3 {
            sums[a] = gx[a].mul_add(level, xg[a].mul_add(f[2], x[a].mul_add(across, sums[a])));
        }
        // From the force and from the dipole to the gradient.
        let level = less(square, f[5], 4.0, f[4]);
        let twist = less(square, f[7], 4.0, f[6]);
        let bend = less(square, f[8], 6.0, f[7]);
        let trace = along.mul_add(f[4], xgx.mul(f[7]));
        let across = along.mul_add(f[5], xgx.mul(f[8]));
        let (mut left, mut right) = (x, x);
        for a in 0..3 {
            left[a] = x[a].mul_add(across, force[a].mul_add(level, gx[a].mul_add(bend, xg[a].mul(f[7]))));
            right[a] = force[a].mul_add(f[4], gx[a].add(xg[a]).mul(f[7]));
        }
        for a in 0..3 {
            for d in 0..3 {
                let straight = left[a].mul_add(x[d], x[a].mul_add(right[d], sums[3 + 3 * a + d]));
                let sum = g[a][d].mul_add(twist, g[d][a].mul_add(f[6], straight));
                sums[3 + 3 * a + d] = if a == d { sum.add(trace) } else { sum };
            }
        }
    }
}

/// `-(square f + factor g)`
#[inline(always)]
fn less<T: Real, V: Lanes<T>>(square: V, f: V, factor: f64, g: V) -> V {
    square.mul_sub_from(f, g.mul(V::splat(T::from_f64(-factor))))
}

#[inline(always)]
fn dot<T: Real, V: Lanes<T>>(a: [V; 3], b: [V; 3]) -> V {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2].mul(b[2])))
}
