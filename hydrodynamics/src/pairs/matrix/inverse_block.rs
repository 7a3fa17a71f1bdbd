//! Small dense matrices.

use crate::pairs::matrix::lanes::{LANES, SimdLanes};
use crate::six_vector::SixVector;
use domain::Vector;
use lubrication::Arithmetic;
use simd::{SimdVector as Width, VectorKernel};

/// Symmetric 6x6 mobility of one particle, from load to motion, stored row by row and padded with zeros to whole SIMD
/// vectors.
#[derive(Debug, Clone, Copy)]
pub struct Block(pub [f64; Block::NUMBERS]);

impl Block {
    /// Stored numbers: a whole SIMD vector can be read from the start of the last row.
    pub const NUMBERS: usize = 5 * 6 + LANES;

    /// Motion under a force.
    pub fn under_force(&self, force: Vector) -> SixVector {
        let column = |k: usize, force: f64| SixVector(std::array::from_fn(|i| self.0[6 * k + i] * force));
        column(0, force.x) + column(1, force.y) + column(2, force.z)
    }

    /// Product of the matrix and a six-vector.
    #[cfg(test)]
    pub fn times(&self, vector: &SixVector) -> SixVector {
        let row = |i: usize| (0..6).map(|k| self.0[6 * i + k] * vector.0[k]).sum();
        SixVector(std::array::from_fn(row))
    }
}

impl Default for Block {
    fn default() -> Self {
        Self([0.0; Self::NUMBERS])
    }
}

/// Products of blocks with one six-vector each.
pub struct Products<'a> {
    pub blocks: &'a [Block],
    pub vectors: &'a [SixVector],
    pub results: &'a mut [SixVector],
}

impl VectorKernel<f64> for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Width<f64>>(self) {
        for ((block, vector), product) in self.blocks.iter().zip(self.vectors).zip(self.results) {
            let mut sum = SimdLanes::<V>::constant(0.0);
            for k in 0..6 {
                // By symmetry a row is a column. Numbers beyond its end are summed too, and discarded.
                sum = sum.plus(SimdLanes::constant(vector.0[k]), SimdLanes::read(&block.0[6 * k..]));
            }
            let mut wide = [0.0; LANES];
            sum.write(&mut wide);
            product.0.copy_from_slice(&wide[..6]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use solver::Real;

    #[test]
    fn products_are_those_of_rows() {
        let block = Block(std::array::from_fn(|k| {
            let (i, j) = (k / 6, k % 6);
            if i == j { 2.0 + i as f64 } else { 1.0 / (1.0 + i as f64 + j as f64) }
        }));
        let vectors = [SixVector([1.0, -2.0, 3.0, 0.5, -0.25, 4.0]), SixVector([0.0, 1.0, 0.0, 0.0, 0.0, -1.0])];
        let mut products = [SixVector::default(); 2];
        f64::dispatch(Products { blocks: &[block; 2], vectors: &vectors, results: &mut products });
        for (product, vector) in products.iter().zip(&vectors) {
            assert!(product.0.iter().zip(block.times(vector).0).all(|(a, b)| (a - b).abs() < 1e-14), "{product:?}");
            let force = SixVector::new(vector.linear(), Vector::ZERO);
            let (found, expected) = (block.under_force(vector.linear()), block.times(&force));
            assert!(found.0.iter().zip(expected.0).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
        }
    }
}
