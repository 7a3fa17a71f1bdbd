//! Small dense matrices.

use super::screw::Screw;
use bytemuck::{Pod, Zeroable};
use std::ops::AddAssign;

/// A matrix that takes the motion of one particle to loads on one particle, row by row.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Block(pub [[f64; 6]; 6]);

impl Block {
    /// The matrix times a screw.
    pub fn times(&self, screw: &Screw) -> Screw {
        let mut product = [0.0; 6];
        for (sum, row) in product.iter_mut().zip(&self.0) {
            for k in 0..6 {
                *sum += row[k] * screw.0[k];
            }
        }
        Screw(product)
    }

    /// The inverse of a symmetric positive definite matrix, by Gauss's and Jordan's elimination without pivoting.
    pub fn inverse(&self) -> Self {
        let mut work = self.0;
        for pivot in 0..6 {
            let scale = 1.0 / work[pivot][pivot];
            work[pivot][pivot] = 1.0;
            work[pivot] = work[pivot].map(|value| value * scale);
            let row = work[pivot];
            for i in (0..6).filter(|&i| i != pivot) {
                let factor = std::mem::take(&mut work[i][pivot]);
                work[i].iter_mut().zip(row).for_each(|(value, r)| *value -= factor * r);
            }
        }
        Self(work)
    }
}

impl AddAssign for Block {
    fn add_assign(&mut self, other: Self) {
        self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened()).for_each(|(a, b)| *a += b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_undoes_the_matrix() {
        let block = Block(std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j { 2.0 + i as f64 } else { 1.0 / (1.0 + i as f64 + j as f64) })
        }));
        let x = Screw([1.0, -2.0, 3.0, 0.5, -0.25, 4.0]);
        let back = block.inverse().times(&block.times(&x));
        assert!(back.0.iter().zip(x.0).all(|(a, b)| (a - b).abs() < 1e-13), "{back:?}");
    }
}
