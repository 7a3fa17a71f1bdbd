//! Solves with the resistance of single spheres and near pairs on a device.

use super::super::succeeded;
use super::super::vectors::{ResidentVector, SharedField};
use gpu::{PairLimits, PairSet, RowVectors};

/// Smallest error of a tightened solve, and the factor by which the error is reduced each time.
const LEAST_TOLERANCE: f64 = 1e-10;
const SHARPER: f64 = 1e-2;

/// Largest number of steps of a solve.
const MOST_STEPS: usize = 2000;

/// The matrix `M_0^-1 + R` of single spheres and near pairs, six numbers a particle, preconditioned by the
/// matrices of groups.
pub(super) struct ResidentPreconditioner {
    field: SharedField,
    preconditioned: ResidentVector,
    directions: [ResidentVector; 2],
    image: ResidentVector,
    tolerance: f64,
}

/// Right-hand side of a solve.
pub(super) struct ResidentLoads {
    /// Given loads, and those that are left.
    pub given: ResidentVector,
    pub residual: ResidentVector,
}

/// Motions, and the loads of near pairs in them.
pub(super) struct LoadedMotions {
    pub motions: ResidentVector,
    pub loads: ResidentVector,
}

impl ResidentPreconditioner {
    /// For stiff pairs, with solves to a relative error.
    pub fn new(field: &SharedField, numbers: usize, tolerance: f64) -> Self {
        let [preconditioned, even, odd, image] = [(); 4].map(|()| ResidentVector::wide(field, numbers));
        Self { field: field.clone(), preconditioned, directions: [even, odd], image, tolerance }
    }

    /// Solves with stiff and soft pairs, to an error of `tolerance`, from motions that are given.
    pub fn solve_with_all(&self, loads: &ResidentLoads, to: &LoadedMotions, tolerance: f64) {
        let (motions, image) = (&to.motions.list, &self.image.list);
        let mut field = self.field.borrow_mut();
        succeeded(field.resisted(PairSet::All, [motions, image]));
        succeeded(field.remainder([&loads.given.list, image], None, &loads.residual.list));
        drop(field);
        self.solve_from(PairSet::All, loads, to, tolerance);
    }

    /// Solves from motions whose residual is given.
    pub fn solve(&self, loads: &ResidentLoads, to: &LoadedMotions) {
        self.solve_from(PairSet::Stiff, loads, to, self.tolerance);
    }

    /// Continues an earlier solve.
    pub fn continue_solve(&self, loads: &ResidentLoads, to: &LoadedMotions) {
        let parts = [&loads.given.list, &to.loads.list];
        succeeded(self.field.borrow_mut().remainder(parts, Some(&to.motions.list), &loads.residual.list));
        self.solve(loads, to);
    }

    fn solve_from(&self, pairs: PairSet, loads: &ResidentLoads, to: &LoadedMotions, tolerance: f64) {
        let at = RowVectors {
            unknowns: to.motions.list,
            residual: loads.residual.list,
            preconditioned: self.preconditioned.list,
            directions: self.directions.each_ref().map(|direction| direction.list),
            image: self.image.list,
        };
        let mut field = self.field.borrow_mut();
        succeeded(field.solve_pairs(pairs, &at, PairLimits { tolerance, steps: MOST_STEPS }));
        let parts = [&loads.given.list, &loads.residual.list];
        succeeded(field.remainder(parts, Some(&to.motions.list), &to.loads.list));
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
