//! Residual of a known solution, and its change.

use super::super::succeeded;
use super::super::vectors::{ResidentVector, SharedField};
use super::{FIVE, RESIDUALS, ResidentSystem, SIX, UNKNOWNS, some_of};
use crate::conjugate_gradients::{Iterate, IterationOutcome, Limits, conjugate_gradients};
use crate::mobility::coupled::{ChangeLimits, ChangedSolution, CoupledResidual, KnownSolution};
use domain::Comm;
use gpu::{ChangeColumns, CoupledVectors, DeviceList, KnownInput, KnownLists, LoadFactors, Orders, StartInput};

/// A known solution on a device, with the loads of near pairs in its motions.
struct ResidentStart {
    motions: ResidentVector,
    loads: ResidentVector,
    moments: ResidentVector,
}

impl ResidentStart {
    /// Copies a solution and computes its unknowns and residual; known loads are those of a list.
    fn new(
        field: &SharedField,
        known: &KnownSolution,
        [x, residual, loads]: [&ResidentVector; 3],
        orders: &Orders,
    ) -> Self {
        let start = Self {
            motions: ResidentVector::wide_of(field, known.motions),
            loads: ResidentVector::wide(field, known.motions.len()),
            moments: ResidentVector::wide_of(field, known.moments),
        };
        let ambient = some_of(known.ambient).map(|values| ResidentVector::wide_of(field, values));
        let known = KnownInput { loads: loads.list, ambient: ambient.as_ref().map(|vector| vector.list) };
        succeeded(field.borrow_mut().start_at([&x.list, &residual.list], &start.input(), &known, orders));
        start
    }

    /// The same with a solution that is on the device, and loads that are known or given, see
    /// [`gpu::SplitFarField::load_known`].
    fn loaded(
        field: &SharedField,
        lists: &KnownLists,
        given: Option<DeviceList>,
        known: &KnownInput,
        [x, residual]: [&ResidentVector; 2],
        orders: &Orders,
    ) -> Self {
        let count = known.loads.count();
        let [motions, loads] = [(); 2].map(|()| ResidentVector::wide(field, count));
        let start = Self { motions, loads, moments: ResidentVector::wide(field, FIVE * count / SIX) };
        let mut split = field.borrow_mut();
        succeeded(split.load_known(lists, given, &start.input(), known));
        succeeded(split.start_at([&x.list, &residual.list], &start.input(), known, orders));
        drop(split);
        start
    }

    fn input(&self) -> StartInput {
        StartInput { motions: self.motions.list, loads: self.loads.list, moments: self.moments.list }
    }
}

/// Residual of a known solution; factors are those to the units of the far field.
pub(super) fn residual(
    field: &SharedField,
    known: &KnownSolution,
    factors: &LoadFactors,
    orders: &Orders,
) -> CoupledResidual {
    let count = known.motions.len() / SIX;
    succeeded(field.borrow_mut().begin_coupled([0.0; FIVE], factors));
    let [x, residual] = [UNKNOWNS, RESIDUALS].map(|numbers| ResidentVector::wide(field, numbers * count));
    let loads = ResidentVector::wide_of(field, known.loads);
    let start = ResidentStart::new(field, known, [&x, &residual, &loads], orders);
    let copied = succeeded(field.borrow_mut().copy_residual(&residual.list, &start.motions.list));
    let [motions, strain_rates, moments_of_pairs] = copied;
    CoupledResidual { motions, strain_rates, moments_of_pairs }
}

/// Solves for the change of a known solution, whose residual it starts from.
pub(super) fn solve(
    field: &SharedField,
    known: &KnownSolution,
    &ChangeLimits { comm, limits, preconditioner }: &ChangeLimits,
    factors: &LoadFactors,
    orders: &Orders,
) -> ChangedSolution {
    let count = known.motions.len() / SIX;
    succeeded(field.borrow_mut().begin_coupled([0.0; FIVE], factors));
    let system = ResidentSystem::new(field, count, preconditioner, orders);
    let mut iteration = ChangeIteration::new(field, count, system);
    let ChangeIteration { system, x, residual, .. } = &iteration;
    succeeded(field.borrow_mut().fill(&system.known.list, known.loads));
    let start = ResidentStart::new(field, known, [x, residual, &system.known], orders);
    let (outcome, at) = iteration.run(comm, limits);
    let copied = succeeded(field.borrow_mut().copy_changed(&at, &start.input()));
    let [motions, moments, moments_of_pairs] = copied;
    ChangedSolution { motions, moments, moments_of_pairs, outcome }
}

/// Iteration for a change, from a residual.
struct ChangeIteration<'a> {
    system: ResidentSystem<'a>,
    x: ResidentVector,
    residual: ResidentVector,
    z: ResidentVector,
}

impl<'a> ChangeIteration<'a> {
    /// With vectors for this many particles, which are undefined.
    fn new(field: &SharedField, count: usize, system: ResidentSystem<'a>) -> Self {
        let [x, z] = [(); 2].map(|()| ResidentVector::wide(field, UNKNOWNS * count));
        Self { system, x, residual: ResidentVector::wide(field, RESIDUALS * count), z }
    }

    /// Iterates from no change, with the last correction refined.
    fn run(&mut self, comm: &Comm, limits: Limits) -> (IterationOutcome, CoupledVectors) {
        let Self { system, x, residual, z } = self;
        succeeded(system.field.borrow_mut().clear_unknowns(&x.list));
        let outcome = conjugate_gradients(comm, system, Iterate { x, residual, z }, limits);
        let at = system.vectors([x, residual, z]);
        system.refine_last(limits.tolerance, &at);
        (outcome, at)
    }
}

/// A solution on a device, with what is known of it.
pub(super) struct KnownOnDevice<'a> {
    pub lists: KnownLists,
    /// Number of particles.
    pub count: usize,
    /// Factors to the units of the far field.
    pub factors: LoadFactors,
    pub orders: &'a Orders,
}

/// Stores the conditions for which a solution is exact under loads, if there are any, and those of near pairs in the
/// background.
pub(super) fn store_conditions(field: &SharedField, known: &KnownOnDevice, given: Option<DeviceList>) {
    let KnownOnDevice { lists, count, factors, orders } = known;
    succeeded(field.borrow_mut().begin_coupled([0.0; FIVE], factors));
    let [x, residual] = [UNKNOWNS, RESIDUALS].map(|numbers| ResidentVector::wide(field, numbers * count));
    let loads = ResidentVector::wide(field, SIX * count);
    let input = KnownInput { loads: loads.list, ambient: None };
    let start = ResidentStart::loaded(field, lists, given, &input, [&x, &residual], orders);
    succeeded(field.borrow_mut().store_residual(lists, &residual.list, &start.input()));
}

/// Solves for the change of a solution from the conditions for which it was exact, and stores it.
pub(super) fn store_change(
    field: &SharedField,
    known: &KnownOnDevice,
    changes: &ChangeColumns,
    &ChangeLimits { comm, limits, preconditioner }: &ChangeLimits,
) -> IterationOutcome {
    let &KnownOnDevice { ref lists, count, ref factors, orders } = known;
    succeeded(field.borrow_mut().begin_coupled([0.0; FIVE], factors));
    let system = ResidentSystem::new(field, count, preconditioner, orders);
    let mut iteration = ChangeIteration::new(field, count, system);
    let ChangeIteration { system, x, residual, .. } = &iteration;
    let ambient = ResidentVector::wide(field, (SIX + FIVE) * count);
    let input = KnownInput { loads: system.known.list, ambient: Some(ambient.list) };
    let start = ResidentStart::loaded(field, lists, None, &input, [x, residual], orders);
    drop(ambient);
    let (outcome, at) = iteration.run(comm, limits);
    succeeded(field.borrow_mut().store_change(lists, changes, &at, &start.input()));
    outcome
}
