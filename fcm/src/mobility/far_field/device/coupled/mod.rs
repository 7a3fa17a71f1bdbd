//! Coupled solve of near pairs and far field on a device: all vectors of the iteration stay there.
//!
//! It follows the solve of `hydrodynamics`, whose equations are there, step by step, in `f64` except for the far field
//! and the numbers of soft pairs.

mod change;
mod preconditioner;
mod problems;

use super::kept_lists::KeptLists;
use super::succeeded;
use super::vectors::{ResidentVector, SharedField};
use crate::conjugate_gradients::{InnerProducts, Iterate, SteppedSystem, Turn, conjugate_gradients};
use crate::mobility::coupled::{CoupledProblem, CoupledSolution, GivenAmbient, GivenLoads, SolutionColumns};
use crate::mobility::loads::Motion;
use domain::{Comm, RemoteList, Vector};
use gpu::{
    AmbientLists, ColumnUnits, CoupledDirection, CoupledSums, CoupledVectors, DeviceList, FoundLists, GuessedVectors,
    KnownInput, LoadFactors, Orders, PairSet, PairSolve, RESIDUALS, StartInput, StoredResult, UNKNOWNS,
};
use preconditioner::ResidentPreconditioner;

/// Numbers of a motion or load, and of a stresslet.
const SIX: usize = 6;
const FIVE: usize = 5;

/// Columns of solutions, and the units of the host over those of a solve.
pub(super) struct SolutionLists<'a> {
    /// The columns.
    pub kept: &'a KeptLists,
    /// Place of each particle in them.
    pub places: &'a [u32],
    /// Positions of particles that move on the device.
    pub positions: Option<&'a RemoteList>,
    /// Units.
    pub units: ColumnUnits,
}

/// The coupled system on a device.
struct ResidentSystem<'a> {
    field: SharedField,
    matrix: ResidentPreconditioner,
    image: ResidentVector,
    known: ResidentVector,
    orders: &'a Orders,
    count: usize,
    /// The last sums.
    sums: CoupledSums,
}

/// Solves a problem; factors are those to the units of the far field.
fn solve(
    field: &SharedField,
    problem: &CoupledProblem,
    lists: &SolutionLists,
    factors: &LoadFactors,
    orders: &Orders,
) -> CoupledSolution {
    let count = lists.places.len();
    succeeded(field.borrow_mut().begin_coupled(problem.background, factors));
    let mut system = ResidentSystem::new(field, count, problem.tolerances.preconditioner, orders);
    let [mut x, mut z] = [(); 2].map(|()| ResidentVector::wide(field, UNKNOWNS * count));
    let mut residual = ResidentVector::wide(field, RESIDUALS * count);
    let columns = system.start(problem, lists, [&x, &residual]);
    let iterate = Iterate { x: &mut x, residual: &mut residual, z: &mut z };
    let outcome = conjugate_gradients(problem.comm, &mut system, iterate, problem.limits);
    let at = system.vectors([&x, &residual, &z]);
    let StoredResult { motions, square, compared } = system.finish(problem, &at, columns.moving.is_some());
    let (velocities, angular_velocities) = motions.split_at(motions.len() / 2);
    let vectors = |list: &[f64]| list.as_chunks().0.iter().map(|&v| Vector::from_array(v)).collect();
    let motion = Motion {
        velocities: vectors(velocities),
        angular_velocities: vectors(angular_velocities),
        strain_rates: Vec::new(),
    };
    if columns.moving.is_none() {
        let [_, _, _, velocity, rotation] = &columns.guessed;
        velocity.receive(velocities.to_vec());
        rotation.receive(angular_velocities.to_vec());
    }
    let compared = problem.past.are_known().then_some(compared);
    CoupledSolution { motion, is_finite: square.is_finite(), columns, compared, outcome }
}

impl<'a> ResidentSystem<'a> {
    /// For this many particles, with the relative error of the preconditioner. Known loads are undefined.
    fn new(field: &SharedField, count: usize, preconditioner: f64, orders: &'a Orders) -> Self {
        Self {
            field: field.clone(),
            matrix: ResidentPreconditioner::new(field, SIX * count, preconditioner),
            image: ResidentVector::wide(field, RESIDUALS * count),
            known: ResidentVector::wide(field, SIX * count),
            orders,
            count,
            sums: CoupledSums::default(),
        }
    }

    /// Unknowns and residual from which the iteration starts: the motions that near pairs have under the loads that
    /// the past solutions lead to. Returns the columns of the solution, which are not known yet.
    fn start(
        &self,
        problem: &CoupledProblem,
        lists: &SolutionLists,
        [x, residual]: [&ResidentVector; 2],
    ) -> SolutionColumns {
        let (field, count) = (&self.field, self.count);
        let [motions, near_loads] = [(); 2].map(|()| ResidentVector::wide(field, SIX * count));
        let moments = ResidentVector::wide(field, FIVE * count);
        let (of_motions, of_loads) = (motions.list, near_loads.list);
        let copied = match problem.loads {
            GivenLoads::Here(loads) => some_of(loads).map(|values| ResidentVector::wide_of(field, values)),
            GivenLoads::Held(_) => None,
        };
        let given = match problem.loads {
            GivenLoads::Here(_) => copied.as_ref().map(|vector| vector.list),
            GivenLoads::Held(held) => held.list().map(|list| lists.kept.held(list)),
        };
        let past = lists.kept.of(problem.past, lists.places);
        let (found, columns) = found(problem, lists);
        let vectors = self.matrix.vectors();
        let (ambient, held) = self.ambient(problem, lists);
        let of_ambient = ambient.as_ref().map(|vector| vector.list);
        let guessed = GuessedVectors {
            known: self.known.list,
            motions: of_motions,
            moving: vectors.given,
            moments: moments.list,
            ambient: held.zip(of_ambient).map(|(given, known)| AmbientLists { given, known }),
        };
        succeeded(field.borrow_mut().guess_coupled(&past, &found, lists.units, given, &guessed));
        let solve = PairSolve { pairs: PairSet::All, motions: of_motions, loads: of_loads, vectors };
        let limits = ResidentPreconditioner::limits_of(problem.tolerances.start);
        succeeded(field.borrow_mut().solve_pairs(&solve, limits));
        let start = StartInput { motions: of_motions, loads: of_loads, moments: moments.list };
        let known = KnownInput { loads: self.known.list, ambient: of_ambient };
        let lists = [&x.list, &residual.list];
        succeeded(field.borrow_mut().start_coupled(lists, &start, &known, self.orders));
        columns
    }

    /// Ambient motions, if there are any, whose values are undefined if they are in another list there.
    fn ambient(&self, problem: &CoupledProblem, lists: &SolutionLists) -> (Option<ResidentVector>, Option<DeviceList>) {
        match &problem.ambient {
            GivenAmbient::Here(values) => (some_of(values).map(|v| ResidentVector::wide_of(&self.field, v)), None),
            GivenAmbient::Held(remote) => {
                let room = ResidentVector::wide(&self.field, (SIX + FIVE) * self.count);
                (Some(room), Some(lists.kept.held(remote)))
            }
        }
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

    /// Result after a last correction, the preconditioned residual, which is refined in the near field.
    fn finish(&mut self, problem: &CoupledProblem, at: &CoupledVectors, are_moving: bool) -> StoredResult {
        self.refine_last(problem.tolerances.end, at);
        let moments = some_of(problem.moments).map(|values| ResidentVector::wide_of(&self.field, values));
        let moments = moments.as_ref().map(|vector| vector.list);
        succeeded(self.field.borrow_mut().store_coupled(at, &self.known.list, moments, are_moving))
    }

    /// Refines the preconditioned residual, the last correction of the unknowns, to an error in the near field relative
    /// to these.
    fn refine_last(&mut self, tolerance: f64, at: &CoupledVectors) {
        let [.., of_x, of_z] = self.sums;
        if self.matrix.tighten_to(tolerance * (of_x / of_z).sqrt()) {
            succeeded(self.field.borrow_mut().refine_coupled(at, self.matrix.limits()));
        }
    }
}

/// Lists of a solution, whose values are undefined, and the columns that stand for them.
fn found(problem: &CoupledProblem, lists: &SolutionLists) -> (FoundLists, SolutionColumns) {
    let moving = problem.moving_in.as_ref().zip(lists.positions).map(|(flow, at)| lists.kept.moving(at, flow));
    let (lists_of_motions, moving) = moving.unzip();
    let (columns, values) = lists.kept.solution(lists.places.len());
    let [stresslet, induced, induced_rotation, velocity, rotation, forces, torques, stresslets, strain_rates] = values;
    let guessed = [stresslet, induced, induced_rotation, velocity, rotation];
    let found = FoundLists { columns, moving: lists_of_motions };
    (found, SolutionColumns { guessed, forces, torques, stresslets, strain_rates, moving })
}

/// A list that is not empty.
fn some_of(values: &[f64]) -> Option<&[f64]> {
    Some(values).filter(|values| !values.is_empty())
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
