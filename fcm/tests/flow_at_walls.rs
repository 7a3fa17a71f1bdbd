//! Rigid spheres in a shear flow along walls, with small motions relative to it.

use crate::common::{Suspension, tensors, vectors};
use domain::{Boundaries, Comm, Partition, PeriodicBox, Tensor, Traceless, Vector};
use fcm::{Loading, Loads, Plan, Problem, Solved, StressletSolver};
use std::f64::consts::PI;

const RATE: f64 = 1.0;

fn slit(edges: [f64; 3]) -> PeriodicBox {
    PeriodicBox::new(Vector::from_array(edges)).unwrap().with_boundaries(Boundaries::Walls).unwrap()
}

fn problem(suspension: &Suspension, loading: Loading, tolerance: f64) -> Problem {
    Problem { rigid: true, loading, ..suspension.problem(tolerance) }
}

fn plan(suspension: &Suspension, loading: Loading, tolerance: f64) -> Plan {
    Plan::choose(&problem(suspension, loading, tolerance)).unwrap()
}

/// Motion relative to the flow `u = z` along x.
fn sheared(suspension: &Suspension, plan: &Plan) -> Solved {
    let gradient = Tensor::from_cols(Vector::ZERO, Vector::ZERO, RATE * Vector::X);
    let mut hydrodynamics = StressletSolver::new(plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
    let (particles, loads) = (suspension.particles(), Loads::default());
    hydrodynamics.solve(&suspension.cell, &particles, &loads, Traceless::part_of(&gradient), &[]).unwrap()
}

/// Errors of velocities, angular velocities and stresslets relative to their norms, each norm at least a tenth of
/// that of isolated spheres in the flow.
fn relative_errors(suspension: &Suspension, found: &Solved, exact: &Solved) -> [f64; 3] {
    let norm = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>().sqrt();
    let single = |of_radius: &dyn Fn(f64) -> f64| {
        let values: Vec<f64> = suspension.radii.iter().map(|&a| 0.1 * of_radius(a) * RATE / 2f64.sqrt()).collect();
        norm(&values)
    };
    let error = |of: &dyn Fn(&Solved) -> Vec<f64>, single: f64| {
        let (found, exact) = (of(found), of(exact));
        let differences: Vec<f64> = found.iter().zip(&exact).map(|(a, b)| a - b).collect();
        norm(&differences) / norm(&exact).max(single)
    };
    let stresslet = 20.0 / 3.0 * PI * suspension.viscosity;
    [
        error(&|solved| vectors(&solved.motion.velocities), single(&|a| a)),
        error(&|solved| vectors(&solved.motion.angular_velocities), single(&|_| 1.0)),
        error(&|solved| tensors(&solved.stresslets), single(&|a| stresslet * a.powi(3))),
    ]
}

/// Two slits slightly wider than two diameters, in which most spheres are at a wall: edges and centres.
const THIN: [([f64; 3], [[f64; 3]; 8]); 2] = [
    (
        [18.0, 19.0, 4.5],
        [
            [12.62, 16.9, 3.1],
            [4.64, 8.59, 3.48],
            [12.73, 2.21, 1.02],
            [12.26, 13.03, 3.48],
            [13.79, 2.86, 3.22],
            [7.58, 11.28, 1.62],
            [15.42, 15.56, 1.46],
            [9.72, 5.03, 2.79],
        ],
    ),
    (
        [8.0, 9.0, 4.5],
        [
            [3.78, 3.04, 2.14],
            [0.92, 5.29, 2.85],
            [0.12, 4.85, 1.02],
            [3.71, 8.17, 3.48],
            [5.8, 0.58, 1.45],
            [2.19, 0.2, 1.02],
            [7.41, 7.25, 1.02],
            [5.3, 7.28, 1.02],
        ],
    ),
];

/// Without lubrication the velocity of a sphere at a wall is the small difference between the flow's and that by its
/// images.
#[test]
fn few_spheres_keep_the_tolerance() {
    let thin = THIN.map(|(edges, centres)| Suspension {
        cell: slit(edges),
        viscosity: 1.0,
        positions: centres.map(Vector::from_array).to_vec(),
        radii: vec![1.0; 8],
    });
    let higher = [([8.0, 9.0, 6.0], 1.4, 4), ([10.0, 11.0, 12.0], 2.0, 6)];
    let higher = higher.map(|(edges, ratio, count)| Suspension::random(count, ratio, slit(edges), 4));
    for suspension in thin.iter().chain(&higher) {
        let exact = sheared(suspension, &plan(suspension, Loading::UniformOnLattice, 1e-7));
        for tolerance in [1e-2, 1e-3, 1e-4] {
            for loading in [Loading::Flow, Loading::UniformOnLattice] {
                let found = sheared(suspension, &plan(suspension, loading, tolerance));
                let errors = relative_errors(suspension, &found, &exact).map(|error| error / tolerance);
                println!("{:?} {loading:?} {tolerance:e}: {errors:.2?}", suspension.cell.edges());
                assert!(errors.iter().all(|error| *error < 1.0), "{loading:?} at {tolerance:e}: {errors:?}");
            }
        }
    }
}

/// One sphere off the midplane, where the angular velocity vanishes, and one near a wall.
#[test]
fn one_sphere_keeps_the_tolerance_at_any_height() {
    for (radius, height) in [(2.0, 9.9), (2.0, 6.811), (1.0, 4.749), (1.0, 1.05)] {
        let suspension = Suspension {
            cell: slit([14.0, 14.0, 12.0]),
            viscosity: 1.0,
            positions: vec![Vector::new(3.1, 5.3, height)],
            radii: vec![radius],
        };
        let exact = sheared(&suspension, &plan(&suspension, Loading::UniformOnLattice, 1e-7));
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let found = sheared(&suspension, &plan(&suspension, Loading::Flow, tolerance));
            let errors = relative_errors(&suspension, &found, &exact);
            assert!(errors.iter().all(|error| *error < tolerance), "{radius} at {height}, {tolerance:e}: {errors:?}");
        }
    }
}

/// Lubrication makes all relative motions of a suspension comparable with the flow, and the errors of many spheres
/// average out.
#[test]
fn many_lubricated_spheres_have_the_plan_of_other_loads() {
    let suspension = Suspension::random(200, 1.0, slit([18.0, 18.0, 16.0]), 1);
    let plan = |loading: Loading, lubricated: bool| {
        Plan::choose(&Problem { lubricated, ..problem(&suspension, loading, 1e-3) }).unwrap()
    };
    assert_eq!(plan(Loading::Flow, true), plan(Loading::Varied, true));
    let points = |plan: &Plan| plan.grid.iter().product::<usize>();
    assert!(points(&plan(Loading::Flow, false)) > points(&plan(Loading::Varied, false)));
}
