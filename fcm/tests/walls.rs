//! Spheres between walls, above a wall, and in layers that are open along z.

use crate::common::{Reference, Suspension, errors, on_ranks, rigid_errors, solved, worst};
use domain::{Boundaries, Comm, Particles, Partition, PeriodicBox, Random, Traceless, Vector};
use fcm::{Fixed, Loads, Mobility, Motion, Output, Plan, Precision, Problem, Solved, StressletSolver};
use std::f64::consts::PI;

fn cell(edges: [f64; 3], boundaries: Boundaries) -> PeriodicBox {
    PeriodicBox::new(Vector::from_array(edges)).unwrap().with_boundaries(boundaries).unwrap()
}

fn slit() -> Reference {
    Reference::read(include_str!("../../validation/data/slit-8.csv"), cell([14.0, 14.0, 12.0], Boundaries::Walls))
}

/// Checks the errors of all spheres, of which some may be at walls.
fn keeps_tolerances(reference: &Reference) {
    let suspension = &reference.suspension;
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let found = solved(suspension, &reference.loads, tolerance);
        let exact =
            Solved { stresslets: reference.stresslets.clone(), motion: reference.motion.clone(), ..found.clone() };
        let errors = rigid_errors(&found, &exact);
        println!("{:?} {tolerance:e} {errors:?}", suspension.cell.boundaries());
        assert!(errors.iter().all(|error| *error < tolerance), "{errors:?} at {tolerance:e}");
    }
}

#[test]
fn rigid_spheres_between_walls_keep_tolerances() {
    keeps_tolerances(&slit());
}

/// Three to thirty spheres of two sizes at random in a cube of unbounded fluid, dilute or dense.
fn random_in_open_space(name: u64) -> Suspension {
    let mut random = Random::new(11, name);
    let count = 3 + (28.0 * random.uniform()) as usize;
    let ratio = 1.0 + 2.0 * random.uniform();
    let fraction = 0.02 + 0.28 * random.uniform();
    let volume = 4.0 / 3.0 * PI * (0..count).map(|i| if i % 2 == 0 { 1.0 } else { ratio.powi(3) }).sum::<f64>();
    let edge = (volume / fraction).cbrt().max(2.5 * ratio);
    let suspension = Suspension::random(count, ratio, PeriodicBox::new(Vector::splat(edge)).unwrap(), name);
    Suspension { cell: cell([edge; 3], Boundaries::Open), ..suspension }
}

/// Against the same computation at 1e-7, under forces and torques of any direction: the induced stresslets have the
/// largest errors.
#[test]
fn random_rigid_spheres_in_open_space_keep_tolerances() {
    let mut worst = [0.0_f64; 3];
    for name in 0..16 {
        let suspension = random_in_open_space(name);
        let loads = Loads { stresslets: Vec::new(), ..suspension.loads(name) };
        let exact = solved(&suspension, &loads, 1e-7);
        for (worst, tolerance) in worst.iter_mut().zip([1e-2, 1e-3, 1e-4]) {
            let errors = rigid_errors(&solved(&suspension, &loads, tolerance), &exact);
            let largest = errors.into_iter().fold(0.0, f64::max);
            assert!(largest < tolerance, "case {name} at {tolerance:e}: {errors:?} of {suspension:?}");
            *worst = worst.max(largest / tolerance);
        }
    }
    println!("errors over tolerances of 1e-2, 1e-3 and 1e-4 at worst: {worst:.2?}");
    // The largest error is not far below the tolerance either.
    assert!(worst.iter().all(|worst| *worst > 0.2), "{worst:?}");
}

#[test]
fn rigid_spheres_in_open_space_keep_tolerances() {
    let text = include_str!("../../validation/data/free-space-8.csv");
    keeps_tolerances(&Reference::read(text, cell([12.0; 3], Boundaries::Open)));
}

/// Random loads of all kinds on spheres at random positions: the mobility is symmetric and the power of loads
/// positive.
fn is_symmetric(suspension: &Suspension, tolerance: f64) {
    let plan = suspension.plan(tolerance, Fixed { precision: Some(Precision::Double), ..Fixed::default() });
    let mut mobility = suspension.mobility(&plan);
    let [first, second] = [1, 2].map(|seed| suspension.loads(seed));
    let [of_first, of_second] = [&first, &second].map(|loads| mobility.apply(loads, Output::All));
    let power = |loads: &Loads, motion: &Motion| -> f64 {
        let sum = |a: &[Vector], b: &[Vector]| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
        let strained = loads.stresslets.iter().zip(&motion.strain_rates).map(|(&s, &e)| s.contract(e)).sum::<f64>();
        sum(&loads.forces, &motion.velocities) + sum(&loads.torques, &motion.angular_velocities) - strained
    };
    let (one_way, other_way) = (power(&first, &of_second), power(&second, &of_first));
    let size = (power(&first, &of_first) * power(&second, &of_second)).sqrt();
    assert!(size > 0.0, "no loads take energy");
    // Pair functions come from tables accurate to a hundredth of the tolerance, but are the same both ways.
    assert!((one_way - other_way).abs() < 1e-12 * size, "{one_way} {other_way}");
}

#[test]
fn the_mobility_is_symmetric() {
    let between = slit().suspension;
    for boundaries in [Boundaries::Walls, Boundaries::Wall, Boundaries::OpenAlongZ, Boundaries::Open] {
        let cell = cell([14.0, 14.0, 12.0], boundaries);
        is_symmetric(&Suspension { cell, ..between.clone() }, 1e-3);
    }
}

fn mobility_of(suspension: &Suspension, tolerance: f64, loads: &Loads) -> Motion {
    suspension.evaluate(&suspension.plan(tolerance, Fixed::default()), loads)
}

/// A second wall far away has no effect but the Couette flow of the mean force.
#[test]
fn a_far_wall_is_not_there() {
    let near = slit().suspension;
    let loads = Loads { forces: near.loads(3).forces, ..Loads::default() };
    let with = |height: f64, boundaries| {
        let suspension = Suspension { cell: cell([14.0, 14.0, height], boundaries), ..near.clone() };
        mobility_of(&suspension, 1e-4, &loads)
    };
    let (wall, walls) = (with(12.0, Boundaries::Wall), with(60.0, Boundaries::Walls));
    // The mean of the forces drives a Couette flow between walls, which falls off like 1 over their distance.
    let (sum, area) = (loads.forces.iter().copied().sum::<Vector>(), 14.0 * 14.0);
    let moment: Vector = loads.forces.iter().zip(&near.positions).map(|(f, x)| *f * x.z).sum();
    let back = moment / (60.0 * area * near.viscosity);
    assert!(sum.length() > 0.1);
    for (row, x) in near.positions.iter().enumerate() {
        let mut expected = wall.velocities[row] - back * x.z;
        expected.z = wall.velocities[row].z;
        let difference = walls.velocities[row] - expected;
        assert!(difference.length() < 1e-3 * wall.velocities[row].length().max(0.02), "{row}: {difference}");
    }
}

/// The spheres of the table, none nearer to a wall than a tenth of its radius.
fn apart() -> Suspension {
    let mut suspension = slit().suspension;
    suspension.positions[0].z = 1.2;
    suspension.positions[1].z = 9.75;
    suspension
}

#[test]
fn reflection_changes_nothing() {
    let suspension = apart();
    let loads = suspension.loads(5);
    let flip = |v: &Vector| Vector::new(v.x, v.y, -v.z);
    let turn = |v: &Vector| Vector::new(-v.x, -v.y, v.z);
    let strain = |t: &Traceless| Traceless([t.0[0], t.0[1], -t.0[2], t.0[3], -t.0[4]]);
    let positions = suspension.positions.iter().map(|x| Vector::new(x.x, x.y, 12.0 - x.z)).collect();
    let mirrored = Suspension { positions, ..suspension.clone() };
    let mirrored_loads = Loads {
        forces: loads.forces.iter().map(flip).collect(),
        torques: loads.torques.iter().map(turn).collect(),
        stresslets: loads.stresslets.iter().map(strain).collect(),
    };
    let (found, back) = (mobility_of(&suspension, 1e-3, &loads), mobility_of(&mirrored, 1e-3, &mirrored_loads));
    let expected = Motion {
        velocities: back.velocities.iter().map(flip).collect(),
        angular_velocities: back.angular_velocities.iter().map(turn).collect(),
        strain_rates: back.strain_rates.iter().map(strain).collect(),
    };
    // Twice the tolerance: both motions have an error.
    assert!(worst(&found, &expected) < 2e-3, "{:?}", errors(&found, &expected));
}

#[test]
fn a_displacement_along_the_walls_changes_nothing() {
    let suspension = apart();
    let loads = suspension.loads(6);
    let displaced = suspension.displaced(Vector::new(3.21, -4.56, 0.0));
    let [found, expected] = [&displaced, &suspension].map(|s| mobility_of(s, 1e-3, &loads));
    // Twice the tolerance: both motions have an error.
    assert!(worst(&found, &expected) < 2e-3, "{:?}", errors(&found, &expected));
}

#[test]
fn ranks_and_units_change_nothing() {
    for boundaries in [Boundaries::Walls, Boundaries::Wall, Boundaries::Open] {
        let suspension = Suspension { cell: cell([14.0, 14.0, 12.0], boundaries), ..slit().suspension };
        let loads = suspension.loads(7);
        let plan = suspension.plan(1e-3, Fixed { precision: Some(Precision::Double), ..Fixed::default() });
        let alone = suspension.evaluate(&plan, &loads);
        for table in [[1, 2], [1, 3], [2, 1], [1, 7], [2, 3]] {
            let answer = |partition: &Partition, particles: &Particles, loads: &Loads| {
                let mut mobility = Mobility::new(&plan, partition);
                mobility.arrange(&suspension.cell, particles);
                (mobility.apply(loads, Output::All), Vec::new())
            };
            let (found, _) = on_ranks(&suspension, &plan, table, &loads, answer);
            assert!(worst(&found, &alone) < 1e-13, "{table:?}: {:?}", errors(&found, &alone));
        }
        // Scaling by powers of two has no round-off.
        let large = Suspension {
            cell: suspension.cell.scaled(1024.0),
            positions: suspension.positions.iter().map(|&x| x * 1024.0).collect(),
            radii: suspension.radii.iter().map(|a| a * 1024.0).collect(),
            viscosity: suspension.viscosity,
        };
        let forces = Loads { forces: loads.forces.clone(), ..Loads::default() };
        let [found, expected] = [&large, &suspension].map(|s| mobility_of(s, 1e-3, &forces).velocities);
        assert!(found.iter().zip(&expected).all(|(found, expected)| *found * 1024.0 == *expected));
    }
}

/// Resistances of FCM near one wall over the exact ones: Stokes' drag times these.
#[test]
fn one_sphere_near_a_wall() {
    let z = 1.543_080_6;
    // A box so wide that its periodic copies add less than a percent.
    let single = Suspension {
        cell: cell([60.0, 60.0, 8.0], Boundaries::Wall),
        viscosity: 1.0,
        positions: vec![Vector::new(7.3, 11.2, z)],
        radii: vec![1.0],
    };
    let plan = Plan::choose(&Problem { rigid: true, ..single.problem(1e-4) }).unwrap();
    let mut hydrodynamics = StressletSolver::new(&plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
    let mut mobility = |force: Vector| {
        let loads = Loads { forces: vec![force], ..Loads::default() };
        let solved = hydrodynamics.solve(&single.cell, &single.particles(), &loads, Traceless::ZERO, &[]).unwrap();
        solved.motion.velocities[0].dot(force) * 6.0 * PI
    };
    let (normal, parallel) = (mobility(Vector::Z), mobility(Vector::X));
    // For free rotation the parallel resistance is YA - YB^2/YC, where YB = -0.03 changes less than the third digit.
    assert!((1.0 / normal / 3.035_994 - 0.967).abs() < 0.002, "{normal}");
    assert!((1.0 / parallel / 1.567_447 - 0.994).abs() < 0.004, "{parallel}");
}
