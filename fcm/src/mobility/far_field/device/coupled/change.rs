//! Residual of a known solution, and its change.

use super::super::succeeded;
use super::super::vectors::{ResidentVector, SharedField};
use super::{FIVE, RESIDUALS, ResidentSystem, SIX, UNKNOWNS, some_of};
use crate::conjugate_gradients::{Iterate, conjugate_gradients};
use crate::mobility::coupled::{ChangeLimits, ChangedSolution, CoupledResidual, KnownSolution};
use gpu::{KnownInput, LoadFactors, Orders, StartInput};

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
    let mut system = ResidentSystem::new(field, count, preconditioner, orders);
    let [mut x, mut z] = [(); 2].map(|()| ResidentVector::wide(field, UNKNOWNS * count));
    let mut residual = ResidentVector::wide(field, RESIDUALS * count);
    succeeded(field.borrow_mut().fill(&system.known.list, known.loads));
    let start = ResidentStart::new(field, known, [&x, &residual, &system.known], orders);
    succeeded(field.borrow_mut().clear_unknowns(&x.list));
    let iterate = Iterate { x: &mut x, residual: &mut residual, z: &mut z };
    let outcome = conjugate_gradients(comm, &mut system, iterate, limits);
    let at = system.vectors([&x, &residual, &z]);
    system.refine_last(limits.tolerance, &at);
    let copied = succeeded(field.borrow_mut().copy_changed(&at, &start.input()));
    let [motions, moments, moments_of_pairs] = copied;
    ChangedSolution { motions, moments, moments_of_pairs, outcome }
}
