//! Rigid spheres solved by the library, on one rank.

use super::{Suspension, error, tensors, vectors};
use domain::{Comm, Partition, Traceless};
use fcm::{Loads, Plan, Problem, Solved, StressletSolver};

/// Rigid spheres under loads.
pub fn solved(suspension: &Suspension, loads: &Loads, tolerance: f64) -> Solved {
    let plan = Plan::choose(&Problem { rigid: true, ..suspension.problem(tolerance) }).unwrap();
    let mut hydrodynamics = StressletSolver::new(&plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
    hydrodynamics.solve(&suspension.cell, &suspension.particles(), loads, Traceless::ZERO, &[]).unwrap()
}

/// Errors of velocities, angular velocities and stresslets.
pub fn rigid_errors(found: &Solved, exact: &Solved) -> [f64; 3] {
    let of = |of: &dyn Fn(&Solved) -> Vec<f64>| error(&of(found), &of(exact));
    [
        of(&|solved| vectors(&solved.motion.velocities)),
        of(&|solved| vectors(&solved.motion.angular_velocities)),
        of(&|solved| tensors(&solved.stresslets)),
    ]
}
