//! Random motions of particles that move where the far field is evaluated: the columns of this module are lists there.

use super::{AMBIENT, AMBIENT_NUMBERS, BROWNIAN, DRIFT_VELOCITY, FiniteDifference, LOADS, RANDOM, STRESSLETS};
use crate::coupled_solver::CoupledSolver;
use crate::solution::Solution;
use domain::{ColumnValues, Particles, PeriodicBox};
use fcm::{ExactConditions, HeldLoads, SolutionColumns, SolveError};

/// Message of a panic, which would be a mistake in the program.
const ELSEWHERE: &str = "the far field moves these particles";

/// [`super::store_solution`] under loads that are where the particles move, with the forces between surfaces that the
/// solver [has taken](CoupledSolver::take_surface_forces).
///
/// # Panics
///
/// Unless these particles have moved where the far field is evaluated, and the solution is there.
pub fn store_held_solution(
    hydrodynamics: &mut CoupledSolver,
    cell: &PeriodicBox,
    particles: &mut Particles,
    loads: &HeldLoads,
    solved: &Solution,
) {
    let SolutionColumns { guessed, .. } = &solved.kept.as_ref().expect(ELSEWHERE).columns;
    let [far_stresslets, _, _, velocities, angular_velocities] = guessed;
    let list = |values: &ColumnValues| values.remote_list().expect(ELSEWHERE).clone();
    let found = hydrodynamics.held_solution([list(velocities), list(angular_velocities)], list(far_stresslets));
    let exact = hydrodynamics.exact_conditions(cell, particles, &found, loads);
    let ExactConditions { loads: [forces, torques], ambient, stresslets } = exact;
    let [velocities, angular_velocities] = found.motions;
    let vectors = RANDOM.into_iter().chain(LOADS).zip([velocities, angular_velocities, forces, torques]);
    let tensors = STRESSLETS.into_iter().zip([found.far_stresslets, stresslets]);
    for (name, width, list) in vectors
        .map(|(name, list)| (name, 3, list))
        .chain(tensors.map(|(name, list)| (name, 5, list)))
        .chain([(AMBIENT, AMBIENT_NUMBERS, ambient)])
    {
        particles.set_column(name, width, ColumnValues::remote(list));
    }
}

/// [`super::store_drift`] without the drift of angular velocities: particles that move where the far field is evaluated
/// have no orientations, and the divergence of the mobility vanishes.
///
/// # Panics
///
/// Unless these particles have moved where the far field is evaluated.
pub fn store_held_drift(
    hydrodynamics: &mut CoupledSolver,
    cell: &PeriodicBox,
    particles: &mut Particles,
    FiniteDifference { over, tolerance, .. }: FiniteDifference,
) -> Result<(), SolveError> {
    let holder = hydrodynamics.holder().expect(ELSEWHERE);
    let motions = RANDOM.map(|name| particles.held_column(name, 3, holder));
    let loads = LOADS.map(|name| particles.held_column(name, 3, holder));
    let [far_stresslets, stresslets] = STRESSLETS.map(|name| particles.held_column(name, 5, holder));
    let ambient = particles.held_column(AMBIENT, AMBIENT_NUMBERS, holder);
    let found = hydrodynamics.held_solution(motions, far_stresslets);
    let exact = ExactConditions { loads, ambient, stresslets };
    let [drift, stresslets] = hydrodynamics.held_change(cell, particles, &found, &exact, [over, tolerance])?;
    particles.set_column(DRIFT_VELOCITY, 3, ColumnValues::remote(drift));
    particles.set_column(BROWNIAN, 5, ColumnValues::remote(stresslets));
    Ok(())
}
