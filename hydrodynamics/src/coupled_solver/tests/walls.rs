//! Lubricated spheres at walls against exact solutions.

use super::*;
use domain::Boundaries;
use lubrication::two_sphere::{Function, SphereWall, WallFunctions};

const HEIGHT: f64 = 16.0;

/// Walls far apart, in a box wide enough that images parallel to the walls matter little.
fn between(radii: &[f64], edge: f64) -> Plan {
    let edges = Vector::new(edge, edge, HEIGHT);
    let problem = Problem { edges, boundaries: Boundaries::Walls, ..problem(edge, radii, 1e-3, 1e-6) };
    Plan::choose(&problem).unwrap()
}

/// Motions of spheres under forces and torques in a linear flow with a strain rate.
fn moved(plan: &Plan, particles: &Particles, [forces, torques]: [&[Vector]; 2], strain: Traceless) -> Solution {
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let mut fluid = CoupledSolver::new(plan, &partition, lubricated_at(Some(LubricationRange::default()))).unwrap();
    let loads = Loads { forces: forces.to_vec(), torques: torques.to_vec(), ..Loads::default() };
    fluid.solve(&plan.cell(), particles, &acting(&loads, strain), Guess::default()).unwrap()
}

/// Exact motion of a free sphere above a wall: velocity and angular velocity (positive for rolling) under a unit force
/// along x, and velocity towards the wall under a unit force.
fn exact(f: &WallFunctions) -> [f64; 3] {
    let (a, b, c) = (6.0 * PI * f[Function::YA], 4.0 * PI * f[Function::YB], 8.0 * PI * f[Function::YC]);
    let determinant = a * c - b * b;
    [c / determinant, -b / determinant, 1.0 / (6.0 * PI * f[Function::XA])]
}

/// Motion along the wall, rotation caused by the force, and motion towards the wall; the same at the upper wall.
/// Tolerance: the other wall, at a distance of 14 radii, and images parallel to the walls.
#[test]
fn one_sphere_at_a_wall_moves_as_the_exact_one_at_any_gap() {
    let plan = between(&[1.0], 40.0);
    for gap in [1e-6, 1e-4, 1e-2, 0.1, 0.5, 1.0] {
        let expected = exact(&SphereWall::get().resistance(gap).unwrap());
        for (place, up) in [(1.0 + gap, 1.0), (HEIGHT - 1.0 - gap, -1.0)] {
            let particles = placed(&[Vector::new(13.0, 7.0, place)], &[1.0]);
            let along = moved(&plan, &particles, [&[Vector::X], &[]], Traceless::ZERO).motion;
            let across = moved(&plan, &particles, [&[Vector::Z], &[]], Traceless::ZERO).motion;
            let turned = along.angular_velocities[0].y * up;
            let found = [along.velocities[0].x, turned, across.velocities[0].z];
            assert!((found[0] / expected[0] - 1.0).abs() < 0.01, "gap {gap}: {found:?}, not {expected:?}");
            // The angular velocity due to the force is small far from the wall.
            assert!((found[1] - expected[1]).abs() < 0.01 * expected[0], "gap {gap}: {found:?}, not {expected:?}");
            assert!((found[2] / expected[2] - 1.0).abs() < 0.01, "gap {gap}: {found:?}, not {expected:?}");
        }
    }
}

/// Free sphere in shear at a wall: gap, velocity over that of the flow at the centre, and angular velocity over half
/// the shear rate, for Goldman, Cox & Brenner's problem in a single layer.
#[test]
fn one_sphere_in_shear_moves_as_the_exact_one() {
    let plan = between(&[1.0], 40.0);
    let cases = [(0.1, 0.73889132, 0.7533979), (0.2, 0.81879642, 0.82711767), (0.5, 0.91468009, 0.91686274)];
    for (gap, velocity, turning) in cases {
        let particles = placed(&[Vector::new(13.0, 7.0, 1.0 + gap)], &[1.0]);
        // Half of a shear rate of 1 in the xz component.
        let motion = moved(&plan, &particles, [&[], &[]], Traceless([0.0, 0.0, 0.5, 0.0, 0.0])).motion;
        let found = [1.0 + motion.velocities[0].x / (1.0 + gap), 1.0 + 2.0 * motion.angular_velocities[0].y];
        assert!((found[0] - velocity).abs() < 5e-3, "gap {gap}: {found:?}, not {velocity}");
        assert!((found[1] - turning).abs() < 5e-3, "gap {gap}: {found:?}, not {turning}");
    }
}

/// The mobility near walls and between near spheres is symmetric in every component (reciprocity).
#[test]
fn the_mobility_at_walls_is_symmetric_and_positive() {
    let plan = between(&[1.0, 1.4], 14.0);
    let places = [Vector::new(3.0, 3.0, 1.02), Vector::new(5.2, 3.4, 1.6), Vector::new(9.0, 9.0, HEIGHT - 1.45)];
    let particles = placed(&places, &[1.0, 1.4, 1.4]);
    let column = |k: usize| {
        let mut loads = [[Vector::ZERO; 3]; 2];
        loads[k % 6 / 3][k / 6][k % 3] = 1.0;
        let motion = moved(&plan, &particles, [&loads[0], &loads[1]], Traceless::ZERO).motion;
        let entry = |l: usize| {
            let vectors = if l % 6 / 3 == 0 { &motion.velocities } else { &motion.angular_velocities };
            vectors[l / 6][l % 3]
        };
        (0..18).map(entry).collect::<Vec<f64>>()
    };
    let matrix: Vec<Vec<f64>> = (0..18).map(column).collect();
    for (k, l) in (0..18).flat_map(|k| (0..k).map(move |l| (k, l))) {
        let size = (matrix[k][k] * matrix[l][l]).sqrt();
        // Tolerance of the iteration.
        let difference = (matrix[k][l] - matrix[l][k]).abs();
        assert!(matrix[k][k] > 0.0 && difference < 1e-4 * size && matrix[k][l].abs() < size, "{k}, {l}: {difference}");
    }
}
