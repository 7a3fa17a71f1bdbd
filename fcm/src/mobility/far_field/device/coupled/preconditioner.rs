//! Vectors and tolerance of the preconditioner's solves on a device.

use super::super::vectors::{ResidentVector, SharedField};
use gpu::{PairLimits, PairVectors};

/// Smallest error of a tightened solve, and the factor by which the error is reduced each time.
const LEAST_TOLERANCE: f64 = 1e-10;
const SHARPER: f64 = 1e-2;

/// Largest number of steps of a solve.
const MOST_STEPS: usize = 2000;

/// Solves with the matrix `M_0^-1 + R` of single spheres and near pairs, six numbers a particle, preconditioned by the
/// matrices of groups.
pub(super) struct ResidentPreconditioner {
    /// Given loads.
    pub given: ResidentVector,
    residual: ResidentVector,
    preconditioned: ResidentVector,
    directions: [ResidentVector; 2],
    image: ResidentVector,
    tolerance: f64,
}

impl ResidentPreconditioner {
    /// With vectors of some numbers, and the relative error of solves with stiff pairs.
    pub fn new(field: &SharedField, numbers: usize, tolerance: f64) -> Self {
        let [given, residual, preconditioned, even, odd, image] =
            [(); 6].map(|()| ResidentVector::wide(field, numbers));
        Self { given, residual, preconditioned, directions: [even, odd], image, tolerance }
    }

    /// Places of the vectors.
    pub fn vectors(&self) -> PairVectors {
        PairVectors {
            given: self.given.list,
            residual: self.residual.list,
            preconditioned: self.preconditioned.list,
            directions: self.directions.each_ref().map(|direction| direction.list),
            image: self.image.list,
        }
    }

    /// Limits of solves.
    pub fn limits(&self) -> PairLimits {
        Self::limits_of(self.tolerance)
    }

    /// Limits of a solve to an error.
    pub fn limits_of(tolerance: f64) -> PairLimits {
        PairLimits { tolerance, steps: MOST_STEPS }
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
    pub fn refine(&mut self) -> bool {
        let can = self.tolerance > LEAST_TOLERANCE;
        self.tolerance = (self.tolerance * SHARPER).max(LEAST_TOLERANCE);
        can
    }
}
