//! Rigid spheres against a dense solve with sums over wavevectors.

use crate::common::{Suspension, at_surfaces, difference, error, tensors};
use domain::{Comm, Partition, PeriodicBox, Traceless, Vector};
use fcm::{Loads, Motion, Plan, Problem, SolveError, Solved, StressletSolver};

const BACKGROUND: Traceless = Traceless([0.1, 0.5, -0.2, -0.3, 0.05]);

fn hydrodynamics(plan: &Plan) -> StressletSolver {
    StressletSolver::new(plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]))
}

fn plan(suspension: &Suspension, tolerance: f64) -> Plan {
    Plan::choose(&Problem { rigid: true, ..suspension.problem(tolerance) }).unwrap()
}

fn solve(suspension: &Suspension, plan: &Plan, loads: &Loads, guess: &[Traceless]) -> Result<Solved, SolveError> {
    hydrodynamics(plan).solve(&suspension.cell, &suspension.particles(), loads, BACKGROUND, guess)
}

fn suspension(edges: [f64; 3], strain: f64, ratio: f64) -> Suspension {
    Suspension::random(6, ratio, PeriodicBox::sheared(Vector::from_array(edges), strain).unwrap(), 3)
}

/// The error of the stresslets is below the tolerance, and so is that of the motions relative to the whole motion at
/// the surfaces, rate of strain included. An angular velocity or, without forces, a velocity is a small remainder
/// without the self mobility: relative to itself its error is unbounded, and exceeds the tolerance in one of a
/// hundred draws.
fn keeps_tolerances(suspension: &Suspension, loads: &Loads) {
    let (stresslets, motion) = suspension.rigid(loads, BACKGROUND);
    let scale = at_surfaces(suspension, &motion).iter().map(|m| m * m).sum::<f64>().sqrt();
    for digits in 2..=10 {
        let tolerance = 10f64.powi(-digits);
        let plan = plan(suspension, tolerance);
        let found = solve(suspension, &plan, loads, &[]).unwrap();
        let error = error(&tensors(&found.stresslets), &tensors(&stresslets));
        println!("rigid {:.2} at {tolerance:e}", tolerance / error);
        assert!(error < tolerance, "stresslets: {error:e} at {tolerance:e}");
        for part in at_surfaces(suspension, &difference(&found.motion, &motion)) {
            assert!(part < tolerance * scale, "motions: {part:e} of {scale:e} at {tolerance:e}");
        }
        let share = plan.iteration_tolerance;
        assert!(found.residual <= share, "the iteration may leave {share}, left {}", found.residual);
        assert!(share <= 0.25 * tolerance);
    }
}

#[test]
fn driven_by_forces_and_torques_in_a_cubic_box() {
    let suspension = suspension([8.0; 3], 0.0, 1.7);
    keeps_tolerances(&suspension, &suspension.loads(1));
}

#[test]
fn driven_by_forces_and_torques_in_a_long_sheared_box() {
    let suspension = suspension([16.0, 7.0, 6.0], 0.9, 1.4);
    keeps_tolerances(&suspension, &suspension.loads(2));
}

/// The background flow alone: the velocities come from the stresslets.
#[test]
fn driven_by_the_background_in_a_sheared_box() {
    keeps_tolerances(&suspension([6.5; 3], -0.3, 1.6), &Loads::default());
}

/// Stresslets are forces of constraint and reduce the power of forces and torques: without a background flow rigid
/// spheres move less along their loads than spheres of fluid would.
#[test]
fn rigidity_slows() {
    let suspension = suspension([7.0; 3], 0.2, 1.5);
    let loads = Loads { stresslets: Vec::new(), ..suspension.loads(4) };
    let plan = plan(&suspension, 1e-8);
    let power = |motion: &Motion| -> f64 {
        let by_forces: f64 = loads.forces.iter().zip(&motion.velocities).map(|(f, v)| f.dot(*v)).sum();
        by_forces + loads.torques.iter().zip(&motion.angular_velocities).map(|(t, w)| t.dot(*w)).sum::<f64>()
    };
    let particles = suspension.particles();
    let rigid = hydrodynamics(&plan).solve(&suspension.cell, &particles, &loads, Traceless::ZERO, &[]).unwrap();
    let free = suspension.evaluate(&plan, &loads);
    assert!(0.0 < power(&rigid.motion) && power(&rigid.motion) < power(&free));
}

#[test]
fn the_solution_as_a_guess_needs_no_iteration() {
    let suspension = suspension([8.0; 3], 0.1, 1.3);
    let loads = suspension.loads(5);
    let plan = plan(&suspension, 1e-6);
    let cold = solve(&suspension, &plan, &loads, &[]).unwrap();
    let warm = solve(&suspension, &plan, &loads, &cold.stresslets).unwrap();
    assert!(cold.iterations > 2);
    assert_eq!((warm.iterations, &warm.stresslets), (0, &cold.stresslets));
    // A guess with an error of a thousandth takes fewer iterations than none.
    let near: Vec<Traceless> = cold.stresslets.iter().map(|&s| s * 1.001).collect();
    let short = solve(&suspension, &plan, &loads, &near).unwrap();
    assert!(0 < short.iterations && short.iterations < cold.iterations);
    // Both stop within a quarter of the tolerance of the solution, by their own estimate.
    assert!(error(&tensors(&short.stresslets), &tensors(&cold.stresslets)) < 0.5 * plan.tolerance);
}
