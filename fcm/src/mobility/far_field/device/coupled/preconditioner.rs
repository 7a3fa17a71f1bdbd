//! Solves with the resistance of single spheres and near pairs on a device.

use super::super::succeeded;
use super::super::vectors::{ResidentVector, SharedField};
use crate::conjugate_gradients::{InnerProducts, Iterate, Limits, Step, SteppedSystem, conjugate_gradients};
use domain::{Comm, Interrupt};
use gpu::{DeviceStep, PairSet, ProductSums, RowVectors};

/// Smallest error of a tightened solve, and the factor by which the error is reduced each time.
const LEAST_TOLERANCE: f64 = 1e-10;
const SHARPER: f64 = 1e-2;

/// Largest number of iterations of a solve.
const MOST_ITERATIONS: usize = 2000;

/// The matrix `M_0^-1 + R` of single spheres and near pairs, six numbers a particle, preconditioned by its diagonal
/// blocks.
pub(super) struct ResidentPreconditioner {
    field: SharedField,
    comm: Comm,
    pairs: PairSet,
    z: ResidentVector,
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

/// Inner products by name.
pub(super) fn named([product, former, error, size]: ProductSums) -> InnerProducts {
    InnerProducts { product, former, error, size }
}

/// A step by its places.
pub(super) fn placed(step: &Step<ResidentVector, ResidentVector>) -> DeviceStep {
    DeviceStep { length: step.length, direction: step.direction.list, image: step.image.list }
}

impl ResidentPreconditioner {
    /// For stiff pairs, with solves to a relative error.
    pub fn new(field: &SharedField, comm: &Comm, numbers: usize, tolerance: f64) -> Self {
        let [z, image] = [(); 2].map(|()| ResidentVector::wide(field, numbers));
        Self { field: field.clone(), comm: comm.clone(), pairs: PairSet::Stiff, z, image, tolerance }
    }

    /// Solves with stiff and soft pairs, to an error of `tolerance`, from motions that are given.
    pub fn solve_with_all(&mut self, loads: &mut ResidentLoads, to: &mut LoadedMotions, tolerance: f64) {
        self.pairs = PairSet::All;
        let (motions, image) = (&to.motions.list, &self.image.list);
        let mut field = self.field.borrow_mut();
        succeeded(field.resisted(self.pairs, [motions, image]));
        succeeded(field.remainder([&loads.given.list, image], None, &loads.residual.list));
        drop(field);
        self.solve_from(loads, to, tolerance);
        self.pairs = PairSet::Stiff;
    }

    /// Solves from motions whose residual is given.
    pub fn solve(&mut self, loads: &mut ResidentLoads, to: &mut LoadedMotions) {
        self.solve_from(loads, to, self.tolerance);
    }

    /// Continues an earlier solve.
    pub fn continue_solve(&mut self, loads: &mut ResidentLoads, to: &mut LoadedMotions) {
        let ResidentLoads { given, residual } = loads;
        let parts = [&given.list, &to.loads.list];
        succeeded(self.field.borrow_mut().remainder(parts, Some(&to.motions.list), &residual.list));
        self.solve(loads, to);
    }

    fn solve_from(&mut self, loads: &mut ResidentLoads, to: &mut LoadedMotions, tolerance: f64) {
        let limits = Limits { tolerance, iterations: MOST_ITERATIONS, interrupt: &Interrupt::NEVER };
        let (comm, mut z) = (self.comm.clone(), self.z.shared());
        let iterate = Iterate { x: &mut to.motions, residual: &mut loads.residual, z: &mut z };
        conjugate_gradients(&comm, self, iterate, limits);
        let parts = [&loads.given.list, &loads.residual.list];
        succeeded(self.field.borrow_mut().remainder(parts, Some(&to.motions.list), &to.loads.list));
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

impl SteppedSystem for ResidentPreconditioner {
    type Unknowns = ResidentVector;
    type Residual = ResidentVector;

    fn curvature(&mut self, direction: &ResidentVector) -> (ResidentVector, f64) {
        let product = self.field.borrow_mut().resisted(self.pairs, [&direction.list, &self.image.list]);
        (self.image.shared(), succeeded(product))
    }

    fn on_step(&mut self, _: f64) {}

    fn refine_preconditioner(&mut self) -> bool {
        false
    }

    fn step_and_measure(
        &mut self,
        Iterate { x, residual, z }: Iterate<ResidentVector, ResidentVector>,
        step: Option<Step<ResidentVector, ResidentVector>>,
    ) -> InnerProducts {
        let at = RowVectors { unknowns: x.list, residual: residual.list, preconditioned: z.list };
        named(succeeded(self.field.borrow_mut().step_pairs(&at, step.as_ref().map(placed).as_ref())))
    }
}
