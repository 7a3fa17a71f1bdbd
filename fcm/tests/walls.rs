//! Spheres between walls, above a wall, and in layers that are open along z.

mod common;

use common::{Reference, Suspension, error, tensors, vectors};
use domain::{Boundaries, Comm, Partition, PeriodicBox, Traceless, Vector};
use fcm::{Evaluation, Hydrodynamics, Loads, Plan, Problem};

fn cell(edges: [f64; 3], boundaries: Boundaries) -> PeriodicBox {
    PeriodicBox::new(Vector::from_array(edges)).unwrap().with_boundaries(boundaries).unwrap()
}

fn slit() -> Reference {
    Reference::read(include_str!("references/slit_8.csv"), cell([14.0, 14.0, 12.0], Boundaries::Walls))
}

#[test]
fn rigid_spheres_between_walls_keep_tolerances() {
    let reference = slit();
    let suspension = &reference.suspension;
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let plan = Plan::choose(&Problem { rigid: true, ..suspension.problem(tolerance) }).unwrap();
        let mut hydrodynamics =
            Hydrodynamics::new(&plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
        let found = hydrodynamics
            .solve(&suspension.cell, &suspension.particles(), &reference.loads, Traceless::ZERO, &[])
            .unwrap();
        let errors = [
            error(&vectors(&found.motion.velocities), &vectors(&reference.motion.velocities)),
            error(&vectors(&found.motion.angular_velocities), &vectors(&reference.motion.angular_velocities)),
            error(&tensors(&found.stresslets), &tensors(&reference.stresslets)),
        ];
        println!("{tolerance:e}: {errors:.1e?}, {}, period {}", plan.in_short(), plan.period);
        assert!(errors.iter().all(|&error| error < tolerance), "{errors:.1e?} at {tolerance:e}");
    }
}
