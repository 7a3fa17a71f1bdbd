//! Squirmers against exact velocities, flows and stresslets.

use super::*;
use domain::Boundaries;
use lubrication::two_sphere::{Function, SlipFunction, SphereWall, SphereWallSlip, TwoSphere, TwoSphereSlip};

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
    fluid.solve(cell, particles, &acting, Guess::default()).unwrap()
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
        fluid.solve(&plan.cell(), &particles, &acting, Guess::default()).unwrap()
    };
    let zeros = Squirming { first: vec![Vector::ZERO; 2], second: vec![Traceless::ZERO; 2] };
    let passive = solve(None);
    assert_eq!(solve(Some(&Squirming::default())), passive);
    assert_eq!(solve(Some(&zeros)).motion, passive.motion);
}

/// Solution of a linear system by elimination.
fn eliminated(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let size = right.len();
    for n in 0..size {
        for m in (0..size).filter(|&m| m != n) {
            let factor = matrix[m][n] / matrix[n][n];
            for k in 0..size {
                matrix[m][k] -= factor * matrix[n][k];
            }
            right[m] -= factor * right[n];
        }
    }
    (0..size).map(|n| right[n] / matrix[n][n]).collect()
}

/// Exact motions of two free squirmers on the z axis whose modes are those of axes in the plane of x and z, `[U_z; 2]`,
/// `[U_x; 2]` and `[Omega_y; 2]`, and the `zz` and `xz` components of their stresslets: with the resistance `R` of the
/// pair and its loads `L` by slip at rest, `R q + L = 0`.
fn exact_pair(ratio: f64, gap: f64, squirming: &Squirming) -> Vec<f64> {
    let functions = TwoSphere::with_ratio(ratio).unwrap().resistance(gap).unwrap();
    let slip = TwoSphereSlip::with_ratio(ratio).unwrap().at(gap);
    let radii = [1.0, ratio];
    let part = |function: Function, power: i32, factor: f64| {
        move |i: usize, j: usize| factor * PI * (radii[i] + radii[j]).powi(power) * functions[function][i][j]
    };
    let (xa, ya, yb) = (part(Function::XA, 1, 3.0), part(Function::YA, 1, 3.0), part(Function::YB, 2, -1.0));
    let (yc, xg, yg) = (part(Function::YC, 3, 1.0), part(Function::XG, 2, 2.0 / 3.0), part(Function::YG, 2, 1.0));
    let yh = part(Function::YH, 3, 1.0);
    let load = |i: usize, of_first: SlipFunction, of_second: SlipFunction| {
        let is_axial = matches!(of_first, SlipFunction::XF1 | SlipFunction::XS1);
        (0..2)
            .map(|j| {
                let (first, second) = (squirming.first[j], squirming.second[j].tensor());
                let amounts = if is_axial { [first.z, 1.5 * second.z_axis.z] } else { [first.x, second.z_axis.x] };
                amounts[0] * of_first.of(&slip, i, j) + amounts[1] * of_second.of(&slip, i, j)
            })
            .sum::<f64>()
    };
    let along = eliminated(
        (0..2).map(|i| (0..2).map(|j| xa(i, j)).collect()).collect(),
        (0..2).map(|i| -load(i, SlipFunction::XF1, SlipFunction::XF2)).collect(),
    );
    let entry = |row: usize, column: usize| match (row / 2, column / 2) {
        (0, 0) => ya(row, column),
        (1, 0) => yb(row - 2, column),
        (0, 1) => yb(column - 2, row),
        _ => yc(row - 2, column - 2),
    };
    let right = |row: usize| match row / 2 {
        0 => -load(row, SlipFunction::YF1, SlipFunction::YF2),
        _ => -load(row - 2, SlipFunction::YT1, SlipFunction::YT2),
    };
    let across = eliminated(
        (0..4).map(|row| (0..4).map(|column| entry(row, column)).collect()).collect(),
        (0..4).map(right).collect(),
    );
    let stretched = (0..2).map(|i| {
        let moved: f64 = (0..2).map(|j| xg(i, j) * along[j]).sum();
        -moved - load(i, SlipFunction::XS1, SlipFunction::XS2)
    });
    let sheared = (0..2).map(|i| {
        let moved: f64 = (0..2).map(|j| yg(i, j) * across[j] + yh(i, j) * across[2 + j]).sum();
        -moved - load(i, SlipFunction::YS1, SlipFunction::YS2)
    });
    let stresslets: Vec<f64> = stretched.chain(sheared).collect();
    [along, across, stresslets].concat()
}

/// Two free pushers or pullers in open space move as the exact solution to 2e-3 of their speed, at any gap: the
/// resistance of passive pairs has such an error. Stresslets are as accurate relative to that of a squirmer alone.
#[test]
#[ignore = "heavy"]
fn two_squirmers_move_as_the_exact_solution() {
    for ratio in [1.0, 2.0] {
        let cell = cube(12.0).with_boundaries(Boundaries::Open).unwrap();
        let open = Problem { boundaries: Boundaries::Open, ..problem(12.0, &[1.0, ratio], 1e-3, 1e-5) };
        let plan = Plan::choose(&open).unwrap();
        let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
        let lubrication = Some(LubricationRange::default());
        let mut fluid = CoupledSolver::new(&plan, &partition, lubricated_at(lubrication)).unwrap();
        for (gap, beta) in [(1e-3, -3.0), (0.1, 3.0), (1.0, -3.0)] {
            let axes = [Vector::new(0.6, 0.0, 0.8), Vector::new(-0.96, 0.0, 0.28)];
            let (first, second) = axes.map(|p| modes(1.0, beta, p)).into_iter().unzip();
            let squirming = Squirming { first, second };
            let at = Vector::new(5.0, 6.0, 4.0);
            let particles = placed(&[at, at + Vector::Z * (1.0 + ratio + gap)], &[1.0, ratio]);
            let loads = Loads::default();
            let acting = SolveInput { squirming: Some(&squirming), ..acting(&loads, Traceless::ZERO) };
            let found = fluid.solve(&cell, &particles, &acting, Guess::default()).unwrap();
            let (u, s) = (&found.motion.velocities, &found.stresslets);
            let omega = &found.motion.angular_velocities;
            let zz = |s: &Traceless| s.tensor().z_axis.z;
            let all =
                [u[0].z, u[1].z, u[0].x, u[1].x, omega[0].y, omega[1].y, zz(&s[0]), zz(&s[1]), s[0].0[2], s[1].0[2]];
            let exact = exact_pair(ratio, gap, &squirming);
            let allowed = |k: usize| if k < 6 { 2e-3 } else { 2e-3 * 4.0 * PI * 3.0 };
            for (k, (found, exact)) in all.iter().zip(&exact).enumerate() {
                assert!(
                    (found - exact).abs() < allowed(k),
                    "ratio {ratio}, gap {gap}, beta {beta}, {k}: {found}, not {exact}"
                );
            }
        }
    }
}

/// Exact motion of a free squirmer of radius 1 at a wall whose normal is z, with modes of an axis in the plane of x and
/// z: `U_z, U_x, Omega_y`. `d` is the sign of the direction from the sphere to the wall.
fn exact_at_wall(gap: f64, d: f64, first: Vector, second: Traceless) -> [f64; 3] {
    let functions = SphereWall::get().resistance(gap).unwrap();
    let slip = SphereWallSlip::get().at(gap);
    let second = second.tensor();
    // In the frame whose z axis points to the wall, turned about x: y changes sign with z.
    let load = |of_first: SlipFunction, of_second: SlipFunction, amounts: [f64; 2]| {
        amounts[0] * slip[of_first as usize] + amounts[1] * slip[of_second as usize]
    };
    let (bent, stretched) = (d * second.z_axis.x, 1.5 * second.z_axis.z);
    let along =
        -load(SlipFunction::XF1, SlipFunction::XF2, [d * first.z, stretched]) / (6.0 * PI * functions[Function::XA]);
    let force = load(SlipFunction::YF1, SlipFunction::YF2, [first.x, bent]);
    let torque = load(SlipFunction::YT1, SlipFunction::YT2, [first.x, bent]);
    let (ya, yb, yc) =
        (6.0 * PI * functions[Function::YA], -4.0 * PI * functions[Function::YB], 8.0 * PI * functions[Function::YC]);
    let across = eliminated(vec![vec![ya, yb], vec![yb, yc]], vec![-force, -torque]);
    [d * along, across[0], d * across[1]]
}

/// A free squirmer at a wall moves as the exact solution, at any gap: to the errors of a passive sphere there, of the
/// method without lubrication beyond its range, and of periodic images.
#[test]
fn a_squirmer_at_a_wall_moves_as_the_exact_solution() {
    let edge = 40.0;
    for (boundaries, d) in [(Boundaries::Wall, -1.0), (Boundaries::Walls, 1.0)] {
        let cell = cube(edge).with_boundaries(boundaries).unwrap();
        let walls = Problem { boundaries, ..problem(edge, &[1.0], 1e-3, 1e-6) };
        let plan = Plan::choose(&walls).unwrap();
        let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
        let mut fluid =
            CoupledSolver::new(&plan, &partition, lubricated_at(Some(LubricationRange::default()))).unwrap();
        for (gap, beta) in [(1e-3, -3.0), (0.05, 3.0), (0.5, -3.0), (2.0, 3.0)] {
            let z = if d > 0.0 { edge - 1.0 - gap } else { 1.0 + gap };
            for p in [Vector::new(0.6, 0.0, 0.8), Vector::new(-0.96, 0.0, 0.28), Vector::Z] {
                let (first, second) = modes(1.0, beta, p);
                let squirming = Squirming { first: vec![first], second: vec![second] };
                let loads = Loads::default();
                let acting = SolveInput { squirming: Some(&squirming), ..acting(&loads, Traceless::ZERO) };
                let particles = placed(&[Vector::new(5.0, 6.0, z)], &[1.0]);
                let found = fluid.solve(&cell, &particles, &acting, Guess::default()).unwrap().motion;
                let (u, omega) = (found.velocities[0], found.angular_velocities[0]);
                let exact = exact_at_wall(gap, d, first, second);
                for (found, exact) in [u.z, u.x, omega.y].into_iter().zip(exact) {
                    assert!((found - exact).abs() < 5e-3, "gap {gap}, axis {p}: {found}, not {exact}");
                }
            }
        }
    }
}
