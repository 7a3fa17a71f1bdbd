//! Diagonal blocks of the resistance matrix.

use crate::bodies::matrix::{SphereResistance, cross_matrix};
use crate::pairs::matrix::inverse_block::Block;
use crate::pairs::matrix::lanes::{LANES, SimdLanes, transpose};
use crate::six_vector::SixVector;
use domain::{Tensor, Vector};
use lubrication::Arithmetic;
use simd::{SimdVector as Width, VectorKernel};

/// Diagonal block of the resistance matrix: forces by velocities and torques by angular velocities, each a symmetric
/// matrix with the components xx, xy, xz, yy, yz, zz, and the vector `c` of the coupling `F = Omega x c`, `L = c x U`.
#[derive(Debug, Clone, Copy, Default)]
pub struct DiagonalBlock<X> {
    pub force: [X; 6],
    pub torque: [X; 6],
    pub coupling: [X; 3],
}

/// Numbers of a block, padded to whole SIMD vectors.
const NUMBERS: usize = 2 * LANES;

impl DiagonalBlock<f64> {
    /// Isotropic resistance to translation.
    pub fn against_velocity(resistance: f64) -> Self {
        Self { force: [resistance, 0.0, 0.0, resistance, 0.0, resistance], ..Self::default() }
    }

    /// Adds another block.
    pub fn add(&mut self, other: &Self) {
        self.force.iter_mut().zip(other.force).for_each(|(sum, value)| *sum += value);
        self.torque.iter_mut().zip(other.torque).for_each(|(sum, value)| *sum += value);
        self.coupling.iter_mut().zip(other.coupling).for_each(|(sum, value)| *sum += value);
    }

    /// Its blocks as matrices.
    pub fn blocks(&self) -> SphereResistance {
        let [force, torque] = [self.force, self.torque]
            .map(|[xx, xy, xz, yy, yz, zz]| Tensor::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]));
        let coupling = cross_matrix(Vector::from_array(self.coupling));
        SphereResistance { force: [force, -coupling], torque: [coupling, torque] }
    }

    /// Numbers of a block.
    pub const OWN_NUMBERS: usize = 15;

    /// Force, torque and coupling, one after the other.
    pub fn own_numbers(&self) -> [f64; Self::OWN_NUMBERS] {
        std::array::from_fn(|k| self.numbers()[k])
    }

    #[inline(always)]
    fn numbers(&self) -> [f64; NUMBERS] {
        let mut numbers = [0.0; NUMBERS];
        numbers[..6].copy_from_slice(&self.force);
        numbers[6..12].copy_from_slice(&self.torque);
        numbers[12..15].copy_from_slice(&self.coupling);
        numbers
    }
}

impl<V: Width<f64>> DiagonalBlock<SimdLanes<V>> {
    /// Blocks of several rows, one per lane; empty lanes are zero.
    #[inline(always)]
    pub fn of(rows: &[DiagonalBlock<f64>]) -> Self {
        let mut records = [[0.0; NUMBERS]; LANES];
        for (record, own) in records.iter_mut().zip(rows) {
            *record = own.numbers();
        }
        let mut lanes = [[0.0; LANES]; NUMBERS];
        for (k, lanes) in lanes.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            transpose::<V, NUMBERS>(&records, k * LANES, lanes);
        }
        let zero = SimdLanes::constant(0.0);
        let mut own = Self { force: [zero; 6], torque: [zero; 6], coupling: [zero; 3] };
        for k in 0..6 {
            own.force[k] = SimdLanes::read(&lanes[k]);
            own.torque[k] = SimdLanes::read(&lanes[6 + k]);
        }
        for k in 0..3 {
            own.coupling[k] = SimdLanes::read(&lanes[12 + k]);
        }
        own
    }
}

impl<X: Arithmetic> DiagonalBlock<X> {
    /// Loads for a velocity and an angular velocity.
    #[inline(always)]
    pub fn times(&self, [[ux, uy, uz], [ox, oy, oz]]: [[X; 3]; 2]) -> [X; 6] {
        let ([a, b, c, d, e, f], [p, q, r, s, t, u]) = (self.force, self.torque);
        let [x, y, z] = self.coupling;
        [
            a * ux + b * uy + c * uz + oy * z - oz * y,
            b * ux + d * uy + e * uz + oz * x - ox * z,
            c * ux + e * uy + f * uz + ox * y - oy * x,
            p * ox + q * oy + r * oz + y * uz - z * uy,
            q * ox + s * oy + t * oz + z * ux - x * uz,
            r * ox + t * oy + u * oz + x * uy - y * ux,
        ]
    }

    /// The full 6x6 matrix.
    #[inline(always)]
    fn matrix(&self) -> [[X; 6]; 6] {
        let mut rows = [[X::constant(0.0); 6]; 6];
        for (corner, [xx, xy, xz, yy, yz, zz]) in [(0, self.force), (3, self.torque)] {
            for (i, row) in [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].into_iter().enumerate() {
                rows[corner + i][corner..corner + 3].copy_from_slice(&row);
            }
        }
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            // Omega x c, and c x U.
            let (c, back) = (self.coupling[k], X::constant(0.0) - self.coupling[k]);
            rows[i][3 + j] = c;
            rows[j][3 + i] = back;
            rows[3 + i][j] = back;
            rows[3 + j][i] = c;
        }
        rows
    }
}

/// Inverse of a symmetric positive definite matrix, by Gauss-Jordan elimination without pivoting.
#[inline(always)]
pub fn inverse<X: Arithmetic>(mut work: [[X; 6]; 6]) -> [[X; 6]; 6] {
    for pivot in 0..6 {
        let scale = X::constant(1.0).over(work[pivot][pivot]);
        work[pivot][pivot] = X::constant(1.0);
        for k in 0..6 {
            work[pivot][k] = work[pivot][k] * scale;
        }
        let row = work[pivot];
        for i in 0..6 {
            if i != pivot {
                let factor = X::constant(0.0) - work[i][pivot];
                work[i][pivot] = X::constant(0.0);
                for k in 0..6 {
                    work[i][k] = work[i][k].plus(factor, row[k]);
                }
            }
        }
    }
    work
}

/// Inverses of the diagonal blocks plus the single-sphere resistances.
pub struct Inverses<'a> {
    pub own: &'a [DiagonalBlock<f64>],
    pub single: &'a [SixVector],
    pub blocks: &'a mut [Block],
}

impl VectorKernel<f64> for Inverses<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Width<f64>>(self) {
        let given = self.own.chunks(LANES).zip(self.single.chunks(LANES));
        for ((own, single), blocks) in given.zip(self.blocks.chunks_mut(LANES)) {
            let mut matrix = DiagonalBlock::<SimdLanes<V>>::of(own).matrix();
            for k in 0..6 {
                // The identity keeps empty lanes invertible.
                let mut alone = [1.0; LANES];
                for (alone, single) in alone.iter_mut().zip(single) {
                    *alone = single.0[k];
                }
                matrix[k][k] = matrix[k][k] + SimdLanes::read(&alone);
            }
            let inverse = inverse(matrix);
            let mut lanes = [[0.0; LANES]; Block::NUMBERS];
            for (lanes, number) in lanes.iter_mut().zip(inverse.as_flattened()) {
                number.write(lanes);
            }
            for (lane, block) in blocks.iter_mut().enumerate() {
                for k in 0..Block::NUMBERS {
                    block.0[k] = lanes[k][lane];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverses_undo_the_blocks_and_what_particles_resist_alone() {
        let own: Vec<DiagonalBlock<f64>> = (0..11)
            .map(|row| {
                let size = 1.0 + f64::from(row);
                DiagonalBlock {
                    force: [3.0, 0.1, -0.2, 2.0, 0.3, size],
                    torque: [1.0, 0.0, 0.1, size, -0.2, 2.0],
                    coupling: [0.1, 0.2, -0.3],
                }
            })
            .collect();
        let single = [SixVector([1.0, 1.0, 1.0, 2.0, 2.0, 2.0]); 11];
        let mut blocks = [Block::default(); 11];
        solver::Real::dispatch(Inverses { own: &own, single: &single, blocks: &mut blocks });
        for (own, block) in own.iter().zip(blocks) {
            let x = [1.0, -2.0, 3.0, 0.5, -0.25, 4.0];
            let mut loads = own.times([[1.0, -2.0, 3.0], [0.5, -0.25, 4.0]]);
            (0..6).for_each(|k| loads[k] += single[0].0[k] * x[k]);
            let back = block.times(&SixVector(loads));
            assert!(back.0.iter().zip(x).all(|(a, b)| (a - b).abs() < 1e-13), "{back:?}");
        }
    }
}
