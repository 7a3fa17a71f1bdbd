//! Coupled solve of near pairs and far field on a device: all vectors of the iteration stay there.
//!
//! It follows the solve of `hydrodynamics`, whose equations are there, step by step, in `f64` except for the far field
//! and the numbers of soft pairs.

mod preconditioner;

use super::succeeded;
use super::vectors::{ResidentVector, SharedField};
use crate::conjugate_gradients::{InnerProducts, Iterate, Linear, Step, SteppedSystem, conjugate_gradients};
use crate::mobility::coupled::{CoupledProblem, CoupledSolution};
use gpu::{CoupledVectors, DeviceStep, KnownInput, LoadFactors, Orders, ProductSums, RESIDUALS, UNKNOWNS};
use preconditioner::{LoadedMotions, ResidentLoads, ResidentPreconditioner};

/// Numbers of a motion or load, and of a stresslet.
const SIX: usize = 6;
const FIVE: usize = 5;

/// The coupled system on a device.
struct ResidentSystem<'a> {
    field: SharedField,
    matrix: ResidentPreconditioner,
    /// Loads of single spheres in the residual of stiff pairs.
    stiff: ResidentLoads,
    image: ResidentVector,
    factors: LoadFactors,
    orders: &'a Orders,
    count: usize,
}

/// Solves a problem; factors are those to the units of the far field.
pub(super) fn solve(
    field: &SharedField,
    problem: &CoupledProblem,
    factors: LoadFactors,
    orders: &Orders,
) -> CoupledSolution {
    let count = problem.loads.len() / SIX;
    succeeded(field.borrow_mut().begin_coupled(problem.background));
    let mut system = ResidentSystem {
        field: field.clone(),
        matrix: ResidentPreconditioner::new(field, SIX * count, problem.tolerances.preconditioner),
        stiff: ResidentLoads {
            given: ResidentVector::wide_of(field, &problem.start.loads),
            residual: ResidentVector::wide(field, SIX * count),
        },
        image: ResidentVector::wide(field, RESIDUALS * count),
        factors,
        orders,
        count,
    };
    let mut x = system.start(problem);
    let mut residual = system.start_residual(problem, &x);
    let mut z = ResidentVector::wide(field, UNKNOWNS * count);
    let iterate = Iterate { x: &mut x, residual: &mut residual, z: &mut z };
    let outcome = conjugate_gradients(problem.comm, &mut system, iterate, problem.limits);
    let values = system.finish(&mut x, &residual, &z, problem.tolerances.end);
    let (motions, rest) = values.split_at(SIX * count);
    let (loads, rest) = rest.split_at(SIX * count);
    let (moments, rest) = rest.split_at(FIVE * count);
    let (strain_rates, first_moments) = rest.split_at(FIVE * count);
    let [motions, loads] = [motions, loads].map(<[f64]>::to_vec);
    let [moments, strain_rates, first_moments] = [moments, strain_rates, first_moments].map(<[f64]>::to_vec);
    CoupledSolution { motions, loads, moments, strain_rates, first_moments, outcome }
}

/// Inner products by name.
fn named([product, former, error, size]: ProductSums) -> InnerProducts {
    InnerProducts { product, former, error, size }
}

/// A step by its places.
fn placed(step: &Step<ResidentVector, ResidentVector>) -> DeviceStep {
    DeviceStep { length: step.length, direction: step.direction.list, image: step.image.list }
}

impl ResidentSystem<'_> {
    /// Unknowns from which the iteration starts: the motions that near pairs have under the loads of the start.
    fn start(&self, problem: &CoupledProblem) -> ResidentVector {
        let numbers = SIX * self.count;
        let motions = ResidentVector::wide_of(&self.field, &problem.start.motions);
        let moved = LoadedMotions { motions, loads: ResidentVector::wide(&self.field, numbers) };
        self.matrix.solve_with_all(&self.stiff, &moved, problem.tolerances.start);
        let x = ResidentVector::wide(&self.field, UNKNOWNS * self.count);
        x.part(4 * numbers, FIVE * self.count)
            .combine([1.0, 0.0], &ResidentVector::wide_of(&self.field, &problem.start.moments));
        let lists = [&moved.motions.list, &moved.loads.list];
        succeeded(self.field.borrow_mut().start_unknowns(lists, &x.list));
        x
    }

    /// Residual of the start.
    fn start_residual(&self, problem: &CoupledProblem, x: &ResidentVector) -> ResidentVector {
        let residual = ResidentVector::wide(&self.field, RESIDUALS * self.count);
        let loads = ResidentVector::wide_of(&self.field, problem.loads);
        let given = Some(&problem.ambient).filter(|list| !list.is_empty());
        let ambient = given.map(|values| ResidentVector::wide_of(&self.field, values));
        let ambient_list = ambient.as_ref().map(|vector| vector.list);
        let known = KnownInput { loads: loads.list, ambient: ambient_list, background: problem.background };
        let lists = [&x.list, &residual.list];
        succeeded(self.field.borrow_mut().start_residual(lists, &known, &self.factors, self.orders));
        residual
    }

    /// Motions and loads of stiff pairs within unknowns.
    fn of_stiff(&self, unknowns: &ResidentVector) -> LoadedMotions {
        let numbers = SIX * self.count;
        LoadedMotions { motions: unknowns.part(0, numbers), loads: unknowns.part(numbers, numbers) }
    }

    fn vectors(&self, [x, residual, z]: [&ResidentVector; 3]) -> CoupledVectors {
        let (unknowns, residual, preconditioned) = (x.list, residual.list, z.list);
        let stiff_loads = [self.stiff.given.list, self.stiff.residual.list];
        CoupledVectors { unknowns, residual, preconditioned, stiff_loads }
    }

    fn measured(&self, vectors: [&ResidentVector; 3]) -> InnerProducts {
        let at = self.vectors(vectors);
        named(succeeded(self.field.borrow_mut().measure_coupled(&at)))
    }

    /// Result after a last correction, the preconditioned residual, which is refined to an error of `tolerance` in the
    /// near field.
    fn finish(
        &mut self,
        x: &mut ResidentVector,
        residual: &ResidentVector,
        z: &ResidentVector,
        tolerance: f64,
    ) -> Vec<f64> {
        let [of_x, of_z] = [&*x, z].map(|vector| self.measured([vector, residual, z]).size);
        if self.matrix.tighten_to(tolerance * (of_x / of_z).sqrt()) {
            self.matrix.continue_solve(&self.stiff, &self.of_stiff(z));
        }
        x.add(1.0, z);
        let at = self.vectors([x, residual, z]);
        succeeded(self.field.borrow_mut().coupled_result(&at))
    }
}

impl SteppedSystem for ResidentSystem<'_> {
    type Unknowns = ResidentVector;
    type Residual = ResidentVector;

    fn curvature(&mut self, direction: &ResidentVector) -> (ResidentVector, f64) {
        let lists = [&direction.list, &self.image.list];
        let product = self.field.borrow_mut().curvature(lists, &self.factors, self.orders);
        (self.image.shared(), succeeded(product))
    }

    fn on_step(&mut self, _: f64) {}

    fn refine_preconditioner(&mut self) -> bool {
        self.matrix.refine()
    }

    fn step_and_measure(
        &mut self,
        Iterate { x, residual, z }: Iterate<ResidentVector, ResidentVector>,
        step: Option<Step<ResidentVector, ResidentVector>>,
    ) -> InnerProducts {
        let at = self.vectors([x, residual, z]);
        succeeded(self.field.borrow_mut().step_coupled(&at, step.as_ref().map(placed).as_ref()));
        self.matrix.solve(&self.stiff, &self.of_stiff(z));
        self.measured([x, residual, z])
    }
}
