//! Squirmers against exact velocities, flows and stresslets.

use super::*;
use crate::squirming::Squirming;
use domain::Boundaries;

/// `B1 p` and `B2 (p p - I/3)` of an axis.
fn modes(first: f64, second: f64, p: Vector) -> (Vector, Traceless) {
    let tensor = domain::Tensor::from_cols(p * p.x, p * p.y, p * p.z);
    (p * first, Traceless::part_of(&tensor) * second)
}

fn swum(cell: &PeriodicBox, plan: &Plan, particles: &Particles, squirming: &Squirming) -> Solution {
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let mut fluid = CoupledSolver::new(plan, &partition, ShortRange::default()).unwrap();
    let loads = Loads::default();
    let acting = SolveInput { squirming: Some(squirming), ..acting(&loads, Traceless::ZERO) };
    fluid.solve(cell, particles, &acting, &Guess::default()).unwrap()
}

fn axis() -> Vector {
    Vector::new(0.48, -0.6, 0.64)
}

/// `U = 2/3 B1 (1 - phi)` in a cubic box, with no stresslet and no rotation by the first mode.
#[test]
fn a_squirmer_in_a_cubic_box_loses_the_volume_fraction() {
    for (edge, radius) in [(7.0, 1.0), (10.0, 1.5)] {
        let plan = plan(edge, &[radius], 1e-9, 1e-9);
        let (first, _) = modes(0.8, 0.0, axis());
        let squirming = Squirming { first: vec![first], second: Vec::new() };
        let solved = swum(&cube(edge), &plan, &placed(&[Vector::new(1.1, 2.3, 0.7)], &[radius]), &squirming);
        let exact = first * (2.0 / 3.0 * (1.0 - domain::sphere::volume(radius) / edge.powi(3)));
        let error = (solved.motion.velocities[0] - exact).length() / exact.length();
        assert!(error < 1e-8, "{error:e}");
        assert!(solved.motion.angular_velocities[0].length() < 1e-8);
        assert!(solved.stresslets[0].contract(solved.stresslets[0]).sqrt() < 1e-7);
    }
}

/// The stresslet of the second mode in a cubic box differs from `4/3 pi mu a^2 B2 (3 p p - I)` by the reaction to
/// images, of the order of the volume fraction.
#[test]
fn the_stresslet_is_that_of_the_second_mode() {
    let deviation = [12.0, 24.0].map(|edge| {
        let plan = plan(edge, &[1.0], 1e-7, 1e-8);
        let squirming = Squirming { first: Vec::new(), second: vec![modes(0.0, -1.3, axis()).1] };
        let solved = swum(&cube(edge), &plan, &placed(&[Vector::new(1.1, 2.3, 0.7)], &[1.0]), &squirming);
        let p = axis();
        let exact = domain::Tensor::from_cols(p * p.x, p * p.y, p * p.z) * 3.0 - domain::Tensor::IDENTITY;
        let exact = Traceless::part_of(&exact) * (-1.3 * 4.0 / 3.0 * PI);
        let active = squirming.stresslets(1.0, &[1.0])[0];
        assert!((active - exact).0.iter().all(|s| s.abs() < 1e-13));
        let rest = solved.stresslets[0] - exact;
        (rest.contract(rest) / exact.contract(exact)).sqrt()
    });
    let fraction = 4.0 / 3.0 * PI / 24.0_f64.powi(3);
    assert!(deviation[1] < 5.0 * fraction, "{deviation:?}");
    assert!(((deviation[0] / deviation[1]).log2() - 3.0).abs() < 0.05, "{deviation:?}");
}

/// A passive sphere far from a squirmer in open space moves with its flow: `u_r = 2/3 B1 (a/r)^3 cos(th) - B2 (a/r)^2
/// P2(cos th)` and `u_th = 1/3 B1 (a/r)^3 sin(th)`, up to terms smaller by `(a/r)^2`.
#[test]
fn a_passive_sphere_moves_with_the_flow_of_a_squirmer() {
    let cell = cube(40.0).with_boundaries(Boundaries::Open).unwrap();
    let (at, x) = (Vector::new(9.0, 10.0, 11.0), Vector::new(12.0, 9.0, 8.0));
    let particles = placed(&[at, at + x], &[1.0, 0.5]);
    let open = Problem { boundaries: Boundaries::Open, ..problem(40.0, &[0.5, 1.0], 1e-6, 1e-8) };
    let plan = Plan::choose(&open).unwrap();
    let (r, n) = (x.length(), x.normalize());
    for (first, second) in [(1.0, 0.0), (0.0, 1.0)] {
        let (one, two) = modes(first, second, axis());
        let squirming = Squirming { first: vec![one, Vector::ZERO], second: vec![two, Traceless::ZERO] };
        let found = swum(&cell, &plan, &particles, &squirming).motion.velocities[1];
        let cos = n.dot(axis());
        let dipole = (n * (3.0 * cos) - axis()) * (first / 3.0 / r.powi(3));
        let exact = dipole - n * (second * (1.5 * cos * cos - 0.5) / (r * r));
        let error = (found - exact).length() / exact.length();
        assert!(error < 2.0 / (r * r) + 1e-3, "{first}, {second}: {error:e}");
    }
}

/// Lists of zeros swim with the bits of no list at all.
#[test]
fn spheres_without_slip_are_passive() {
    let plan = plan(8.0, &[1.0], 1e-4, 1e-5);
    let particles = placed(&[Vector::splat(1.0), Vector::new(4.5, 3.0, 2.0)], &[1.0, 1.0]);
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let mut fluid = CoupledSolver::new(&plan, &partition, lubricated_at(Some(LubricationRange::default()))).unwrap();
    let loads = Loads { forces: vec![Vector::X, Vector::new(0.0, 0.4, -1.0)], ..Loads::default() };
    let mut solve = |squirming: Option<&Squirming>| {
        let acting = SolveInput { squirming, ..acting(&loads, Traceless([0.0, 0.5, 0.0, 0.0, 0.0])) };
        fluid.solve(&plan.cell(), &particles, &acting, &Guess::default()).unwrap()
    };
    let zeros = Squirming { first: vec![Vector::ZERO; 2], second: vec![Traceless::ZERO; 2] };
    let passive = solve(None);
    assert_eq!(solve(Some(&Squirming::default())), passive);
    assert_eq!(solve(Some(&zeros)).motion, passive.motion);
}
