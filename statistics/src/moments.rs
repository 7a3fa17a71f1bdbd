//! Sums over vectors, which may be taken in parts.

use bytemuck::{Pod, Zeroable};
use domain::Vector;

/// Number and sum of vectors. Those of parts are added number by number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct VectorSum {
    /// Number of vectors.
    pub count: f64,
    /// Sum of the vectors.
    pub sum: Vector,
}

impl VectorSum {
    /// Adds a vector.
    pub fn add(&mut self, vector: Vector) {
        self.count += 1.0;
        self.sum += vector;
    }

    /// Mean of the vectors; zero if there are none.
    pub fn mean(&self) -> Vector {
        self.sum / self.count.max(1.0)
    }
}

/// `sum (v - m)(v - m)` over vectors `v` about a mean `m`: xx xy xz yy yz zz. Sums of parts about the mean of all are
/// added number by number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct SecondMoments(pub [f64; 6]);

/// Components of a symmetric tensor, in the order xx, xy, xz, yy, yz, zz.
pub(crate) const COMPONENTS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

impl SecondMoments {
    /// Adds a vector, given relative to the mean.
    pub fn add(&mut self, from_mean: Vector) {
        for (sum, (i, j)) in self.0.iter_mut().zip(COMPONENTS) {
            *sum += from_mean[i] * from_mean[j];
        }
    }
}
