//! Coupled solve of near pairs and far field on a device: all vectors of the iteration stay there.
//!
//! It follows the solve of `hydrodynamics`, whose equations are there, step by step, in `f64` except for the far field
//! and the numbers of soft pairs.

mod preconditioner;

use super::succeeded;
use super::vectors::{ResidentVector, SharedField};
use crate::conjugate_gradients::{InnerProducts, Iterate, SteppedSystem, Turn, conjugate_gradients};
use crate::mobility::coupled::{CoupledProblem, CoupledSolution};
use domain::Comm;
use gpu::{
    CoupledDirection, CoupledSums, CoupledVectors, KnownInput, LoadFactors, Orders, PairSet, PairSolve, RESIDUALS,
    StartInput, UNKNOWNS,
};
use preconditioner::ResidentPreconditioner;

/// Numbers of a motion or load, and of a stresslet.
const SIX: usize = 6;
const FIVE: usize = 5;

/// The coupled system on a device.
struct ResidentSystem<'a> {
    field: SharedField,
    matrix: ResidentPreconditioner,
    image: ResidentVector,
    orders: &'a Orders,
    count: usize,
    /// The last sums.
    sums: CoupledSums,
}

/// Solves a problem; factors are those to the units of the far field.
pub(super) fn solve(
    field: &SharedField,
    problem: &CoupledProblem,
    factors: &LoadFactors,
    orders: &Orders,
) -> CoupledSolution {
    let count = problem.loads.len() / SIX;
    succeeded(field.borrow_mut().begin_coupled(problem.background, factors));
    let mut system = ResidentSystem {
        field: field.clone(),
        matrix: ResidentPreconditioner::new(field, &problem.start.loads, problem.tolerances.preconditioner),
        image: ResidentVector::wide(field, RESIDUALS * count),
        orders,
        count,
        sums: CoupledSums::default(),
    };
    let [mut x, mut z] = [(); 2].map(|()| ResidentVector::wide(field, UNKNOWNS * count));
    let mut residual = ResidentVector::wide(field, RESIDUALS * count);
    system.start(problem, [&x, &residual]);
    let iterate = Iterate { x: &mut x, residual: &mut residual, z: &mut z };
    let outcome = conjugate_gradients(problem.comm, &mut system, iterate, problem.limits);
    let values = system.finish(&system.vectors([&x, &residual, &z]), problem.tolerances.end);
    let (motions, rest) = values.split_at(SIX * count);
    let (loads, rest) = rest.split_at(SIX * count);
    let (moments, rest) = rest.split_at(FIVE * count);
    let (strain_rates, first_moments) = rest.split_at(FIVE * count);
    let [motions, loads] = [motions, loads].map(<[f64]>::to_vec);
    let [moments, strain_rates, first_moments] = [moments, strain_rates, first_moments].map(<[f64]>::to_vec);
    CoupledSolution { motions, loads, moments, strain_rates, first_moments, outcome }
}

impl ResidentSystem<'_> {
    /// Unknowns and residual from which the iteration starts: the motions that near pairs have under the loads of the
    /// start.
    fn start(&self, problem: &CoupledProblem, [x, residual]: [&ResidentVector; 2]) {
        let field = &self.field;
        let motions = ResidentVector::wide_of(field, &problem.start.motions);
        let near_loads = ResidentVector::wide(field, SIX * self.count);
        let (of_motions, of_loads) = (motions.list, near_loads.list);
        let vectors = self.matrix.vectors();
        let solve = PairSolve { pairs: PairSet::All, motions: of_motions, loads: of_loads, vectors };
        let limits = ResidentPreconditioner::limits_of(problem.tolerances.start);
        succeeded(field.borrow_mut().solve_pairs(&solve, limits));
        let moments = ResidentVector::wide_of(field, &problem.start.moments);
        let start = StartInput { motions: of_motions, loads: of_loads, moments: moments.list };
        let loads = ResidentVector::wide_of(field, problem.loads);
        let given = Some(&problem.ambient).filter(|list| !list.is_empty());
        let ambient = given.map(|values| ResidentVector::wide_of(field, values));
        let known = KnownInput { loads: loads.list, ambient: ambient.as_ref().map(|vector| vector.list) };
        let lists = [&x.list, &residual.list];
        succeeded(field.borrow_mut().start_coupled(lists, &start, &known, self.orders));
    }

    fn vectors(&self, [x, residual, z]: [&ResidentVector; 3]) -> CoupledVectors {
        let (unknowns, residual, preconditioned) = (x.list, residual.list, z.list);
        CoupledVectors { unknowns, residual, preconditioned, stiff: self.matrix.vectors() }
    }

    /// Notes the sums of a step.
    fn noted(&mut self, sums: CoupledSums) -> InnerProducts {
        self.sums = sums;
        let [product, former, error, size, _] = sums;
        InnerProducts { product, former, error, size }
    }

    /// Result after a last correction, the preconditioned residual, which is refined to an error of `tolerance` in the
    /// near field.
    fn finish(&mut self, at: &CoupledVectors, tolerance: f64) -> Vec<f64> {
        let [.., of_x, of_z] = self.sums;
        let mut field = self.field.borrow_mut();
        if self.matrix.tighten_to(tolerance * (of_x / of_z).sqrt()) {
            succeeded(field.refine_coupled(at, self.matrix.limits()));
        }
        succeeded(field.coupled_result(at))
    }
}

impl SteppedSystem for ResidentSystem<'_> {
    type Unknowns = ResidentVector;
    type Residual = ResidentVector;

    fn refine_preconditioner(&mut self) -> bool {
        self.matrix.refine()
    }

    fn measure(&mut self, at: Iterate<ResidentVector, ResidentVector>) -> InnerProducts {
        let at = self.vectors([at.x, at.residual, at.z]);
        let sums = succeeded(self.field.borrow_mut().measure_coupled(&at, self.matrix.limits()));
        self.noted(sums)
    }

    fn advance(
        &mut self,
        _: &Comm,
        at: Iterate<ResidentVector, ResidentVector>,
        direction: &mut Option<ResidentVector>,
        turn: Turn,
    ) -> InnerProducts {
        let numbers = UNKNOWNS * self.count;
        let direction = direction.get_or_insert_with(|| ResidentVector::wide(&self.field, numbers)).list;
        let Turn { factor, product } = turn;
        let along = CoupledDirection { direction, image: self.image.list, turn: factor, product };
        let at = self.vectors([at.x, at.residual, at.z]);
        let limits = self.matrix.limits();
        let sums = succeeded(self.field.borrow_mut().iterate_coupled(&at, &along, limits, self.orders));
        self.noted(sums)
    }
}
