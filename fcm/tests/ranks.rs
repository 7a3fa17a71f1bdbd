//! The answer is the same on any number of ranks and threads.

use crate::common::{Suspension, error, on_ranks, tensors, vectors, worst};
use domain::{PeriodicBox, Traceless, Vector};
use fcm::{Fixed, Loads, Method, Mobility, Motion, Output, Plan, Precision, StressletSolver};

/// Tables in which ranks own slabs, pencils, or nothing.
const TABLES: [[usize; 2]; 12] =
    [[1, 1], [1, 2], [2, 1], [3, 1], [1, 4], [2, 2], [4, 1], [1, 7], [7, 1], [1, 13], [4, 4], [8, 8]];
const BACKGROUND: Traceless = Traceless([0.3, -0.1, 0.2, 0.4, -0.5]);

fn suspension() -> Suspension {
    let cell = PeriodicBox::sheared(Vector::new(9.0, 7.0, 8.0), 0.3).unwrap();
    Suspension::random(13, 1.4, cell, 2)
}

fn mobility(suspension: &Suspension, plan: &Plan, table: [usize; 2], loads: &Loads) -> Motion {
    let answer = |partition: &domain::Partition, particles: &domain::Particles, loads: &Loads| {
        let mut mobility = Mobility::new(plan, partition);
        mobility.arrange(&suspension.cell, particles);
        (mobility.apply(loads, Output::All), Vec::new())
    };
    on_ranks(suspension, plan, table, loads, answer).0
}

fn rigid(suspension: &Suspension, plan: &Plan, table: [usize; 2], loads: &Loads) -> (Motion, Vec<Traceless>) {
    on_ranks(suspension, plan, table, loads, |partition, particles, loads| {
        let mut hydrodynamics = StressletSolver::new(plan, partition);
        let solved = hydrodynamics.solve(&suspension.cell, particles, loads, BACKGROUND, &[]).unwrap();
        (solved.motion, solved.stresslets)
    })
}

fn fixed(method: Method) -> Fixed {
    Fixed { method: Some(method), precision: Some(Precision::Double), ..Fixed::default() }
}

/// Sums are taken in a different order, so the last digits differ: 1e-12 leaves room for that, but not for a missing
/// image.
#[test]
fn any_table_of_ranks_agrees_with_one_rank() {
    let suspension = suspension();
    let loads = suspension.loads(7);
    for method in [Method::Direct, Method::Split] {
        let plan = suspension.plan(1e-3, fixed(method));
        let alone = suspension.evaluate(&plan, &loads);
        for table in TABLES {
            let error = worst(&mobility(&suspension, &plan, table, &loads), &alone);
            assert!(error < 1e-12, "{method:?} on {table:?}: {error:e}");
        }
    }
}

#[test]
fn rigid_spheres_agree_on_any_table_of_ranks() {
    let suspension = suspension();
    let loads = suspension.loads(8);
    for method in [Method::Direct, Method::Split] {
        let plan = suspension.plan(1e-3, fixed(method));
        let (alone, stresslets) = rigid(&suspension, &plan, [1, 1], &loads);
        for table in TABLES {
            let (motion, found) = rigid(&suspension, &plan, table, &loads);
            let error = worst(&motion, &alone).max(error(&tensors(&found), &tensors(&stresslets)));
            assert!(error < 1e-12, "{method:?} on {table:?}: {error:e}");
        }
    }
}

/// A grid with 4 x 4 rows on up to 64 ranks, most of which own no particle, and some no row.
#[test]
fn more_ranks_than_lines_and_ranks_without_particles() {
    let cell = PeriodicBox::new(Vector::new(8.0, 4.0, 4.0)).unwrap();
    let suspension = Suspension::random(2, 1.5, cell, 4);
    let loads = suspension.loads(9);
    for method in [Method::Direct, Method::Split] {
        let choice = Fixed { grid: Some([16, 4, 4]), ..fixed(method) };
        let plan = suspension.plan(0.1, choice);
        let alone = rigid(&suspension, &plan, [1, 1], &loads);
        for table in [[1, 7], [7, 1], [5, 1], [3, 2], [1, 13], [4, 4], [8, 8], [64, 1]] {
            let (motion, stresslets) = rigid(&suspension, &plan, table, &loads);
            let error = worst(&motion, &alone.0).max(error(&tensors(&stresslets), &tensors(&alone.1)));
            assert!(error < 1e-12, "{method:?} on {table:?}: {error:e}");
        }
    }
}

/// Loads of one kind: ranks without particles have empty lists of every kind.
#[test]
fn kinds_of_load_are_known_to_all_ranks() {
    let cell = PeriodicBox::new(Vector::splat(7.0)).unwrap();
    let suspension = Suspension::random(2, 1.2, cell, 6);
    let all = suspension.loads(3);
    let kinds = [
        Loads { forces: all.forces, ..Loads::default() },
        Loads { torques: all.torques, ..Loads::default() },
        Loads { stresslets: all.stresslets, ..Loads::default() },
    ];
    for (method, loads) in [Method::Direct, Method::Split].iter().flat_map(|m| kinds.iter().map(move |k| (m, k))) {
        let plan = suspension.plan(1e-2, fixed(*method));
        let alone = suspension.evaluate(&plan, loads);
        let four = mobility(&suspension, &plan, [2, 2], loads);
        // Values that vanish by symmetry are round-off, so all are compared to the size of the largest.
        let [v, w, e] = [vectors(&four.velocities), vectors(&four.angular_velocities), tensors(&four.strain_rates)];
        let [p, q, r] = [vectors(&alone.velocities), vectors(&alone.angular_velocities), tensors(&alone.strain_rates)];
        let error = error(&[v, w, e].concat(), &[p, q, r].concat());
        assert!(error < 1e-12, "{method:?}: {error:e}");
    }
}

/// Bit for bit, in both precisions, with stencils that wrap around the box and with others.
#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let cell = PeriodicBox::sheared(Vector::new(14.0, 12.0, 16.0), -0.2).unwrap();
    let suspension = Suspension::random(150, 1.3, cell, 1);
    let loads = suspension.loads(2);
    for (method, precision) in [
        (Method::Direct, Precision::Single),
        (Method::Direct, Precision::Double),
        (Method::Split, Precision::Single),
        (Method::Split, Precision::Double),
    ] {
        let plan = suspension.plan(1e-3, Fixed { precision: Some(precision), ..fixed(method) });
        let [one, two, three] = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| rigid_alone(&suspension, &plan, &loads))
        });
        assert!(one == two && one == three, "{method:?} in {precision:?}");
    }
}

fn rigid_alone(suspension: &Suspension, plan: &Plan, loads: &Loads) -> (Motion, Vec<Traceless>) {
    let partition = domain::Partition::new(&domain::Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let mut hydrodynamics = StressletSolver::new(plan, &partition);
    let solved = hydrodynamics.solve(&suspension.cell, &suspension.particles(), loads, BACKGROUND, &[]).unwrap();
    (solved.motion, solved.stresslets)
}
