//! Lubricated spheres against exact solutions and a dense solve, on any number of ranks and threads.

mod bodies;
mod constant_flux;
mod device_alone;
mod device_contacts;
mod device_displaced;
mod device_memory;
mod device_noise;
mod device_pairs;
mod device_ranks;
mod device_squirmers;
mod device_surface;
mod device_walls;
mod on_device;
mod springs;
mod squeezed;
mod squirming;
mod system;
mod units;
mod walls;

use super::*;
use crate::ambient::StrainRate;
use crate::pairs::search::{Connections, NearPairs};
use crate::six_vector::SixVectors;
use crate::solution::NO_AMBIENT;
use crate::springs::Springs;
use crate::squirming::Squirming;
use domain::{Comm, DomainView, Traceless, Vector, random_packing};
use fcm::{Costs, Fixed, Loading, Multipoles, Output, Precision, Problem};
use lubrication::{PairMotion, SlipForce};
use std::f64::consts::PI;

/// Rigid spheres in a periodic cube, with a double-precision grid; a single-precision grid would add noise of 1e-7.
fn problem(edge: f64, radii: &[f64], tolerance: f64, iteration: f64) -> Problem {
    Problem {
        edges: Vector::splat(edge),
        boundaries: domain::Boundaries::Periodic,
        volume: edge.powi(3),
        shortest_vector: edge,
        smallest_edge_ratio: 1.0,
        largest_strain: 0.0,
        largest_tilts: [0.0; 2],
        radii: radii.iter().map(|&a| (a, 1)).collect(),
        viscosity: 1.0,
        multipoles: Multipoles::Dipole,
        rigid: true,
        lubricated: true,
        loading: Loading::Varied,
        tolerance,
        threads: 1,
        ranks: 1,
        costs: Costs::default(),
        network: None,
        fixed: Fixed { iteration_tolerance: Some(iteration), precision: Some(Precision::Double), ..Fixed::default() },
    }
}

fn plan(edge: f64, radii: &[f64], tolerance: f64, iteration: f64) -> Plan {
    Plan::choose(&problem(edge, radii, tolerance, iteration)).unwrap()
}

fn placed(positions: &[Vector], radii: &[f64]) -> Particles {
    let mut particles = Particles::default();
    for (id, (&position, &radius)) in positions.iter().zip(radii).enumerate() {
        particles.push(id as u64, position, radius, 0);
    }
    particles
}

fn lubricated_at(lubrication: Option<LubricationRange>) -> ShortRange {
    ShortRange { lubrication, ..ShortRange::default() }
}

fn acting(loads: &Loads, strain_rate: Traceless) -> SolveInput<'_> {
    SolveInput::new(loads, StrainRate::uniform(strain_rate))
}

fn cube(edge: f64) -> PeriodicBox {
    PeriodicBox::new(Vector::splat(edge)).unwrap()
}

/// Solution on one rank, with the particles in the given order.
fn solve(
    plan: &Plan,
    particles: &Particles,
    forces: &[Vector],
    strain: Traceless,
    range: Option<LubricationRange>,
) -> Solution {
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let mut fluid = CoupledSolver::new(plan, &partition, lubricated_at(range)).unwrap();
    let loads = Loads { forces: forces.to_vec(), ..Loads::default() };
    fluid.solve(&plan.cell(), particles, &acting(&loads, strain), Guess::default()).unwrap()
}

/// Two spheres with the line of centres along z, in a box large enough that images change the results, for zero total
/// force and in strain, by less than a thousandth.
fn pair(gap: f64, radii: [f64; 2]) -> (Plan, Particles) {
    let edge = 50.0;
    let middle = Vector::splat(0.5 * edge);
    let positions = [middle, middle + Vector::Z * (radii[0] + radii[1] + gap)];
    (plan(edge, &radii, 1e-4, 1e-6), placed(&positions, &radii))
}

/// Relative motions and stresslets in strain against the exact solution: A, B and C of Batchelor & Green (1972), and
/// the stresslets along and across the line of centres over that of a single sphere.
#[test]
fn equal_spheres_in_strain_move_as_the_exact_ones() {
    let cases = [
        (1e-4, [0.999592716697413, 0.315764058354106, 0.47236406923032, 1.9100438592578, 1.07437791645729]),
        (1e-2, [0.961945931219358, 0.246080730656266, 0.380579701551518, 1.87309525182242, 1.02203803538409]),
        (0.5, [0.347646499774256, 0.0564953581400892, 0.145121799968289, 1.31250086404917, 0.939513613926069]),
    ];
    for (gap, [a, b, c, along, across]) in cases {
        let (plan, particles) = pair(gap, [1.0; 2]);
        let distance = 2.0 + gap;
        let axial =
            solve(&plan, &particles, &[], Traceless([-0.5, 0.0, 0.0, -0.5, 0.0]), Some(LubricationRange::default()));
        let shear =
            solve(&plan, &particles, &[], Traceless([0.0, 0.0, 1.0, 0.0, 0.0]), Some(LubricationRange::default()));
        let apart = |solved: &Solution| (solved.motion.velocities[1] - solved.motion.velocities[0]) / distance;
        let zz = -(axial.stresslets[0].0[0] + axial.stresslets[0].0[3]);
        let found = [
            -apart(&axial).z,
            -apart(&shear).x,
            shear.motion.angular_velocities[0].y,
            zz / (20.0 / 3.0 * PI),
            shear.stresslets[0].0[2] / (20.0 / 3.0 * PI),
        ];
        for (k, (found, exact)) in found.into_iter().zip([a, b, c, along, across]).enumerate() {
            // Tolerance: images, and the cutoff of lubrication at 2.5 radii.
            assert!((found - exact).abs() < 0.002 * exact, "gap {gap}, answer {k}: {found}, exact {exact}");
        }
        // 1 - A is the relative rate of approach.
        let approach = 1.0 + apart(&axial).z;
        assert!((approach / (1.0 - a) - 1.0).abs() < 0.02, "gap {gap}: {approach} of {}", 1.0 - a);
    }
}

/// Opposite forces along and across the line of centres: relative velocities against the exact mobility functions.
#[test]
fn forced_pairs_move_as_the_exact_ones() {
    for (ratio, gap) in [(1.0, 1e-3), (2.0, 1e-3), (2.0, 0.1)] {
        let (plan, particles) = pair(gap, [1.0, ratio]);
        let exact = lubrication::two_sphere::TwoSphere::with_ratio(ratio).unwrap().mobility(gap).unwrap();
        for (direction, function) in
            [(Vector::Z, lubrication::two_sphere::Function::XA), (Vector::X, lubrication::two_sphere::Function::YA)]
        {
            let forces = [direction * 6.0 * PI, -direction * 6.0 * PI];
            let solved = solve(&plan, &particles, &forces, Traceless::ZERO, Some(LubricationRange::default()));
            let found = (solved.motion.velocities[0] - solved.motion.velocities[1]).dot(direction);
            let [[first, mutual], [_, second]] = exact[function];
            let wanted = first + second / ratio - 4.0 * mutual / (1.0 + ratio);
            assert!((found / wanted - 1.0).abs() < 0.01, "ratio {ratio} gap {gap}: {found}, exact {wanted}");
        }
    }
}

#[test]
fn without_near_pairs_it_is_the_far_field_to_the_bit() {
    // Lubrication ends at a gap of 2.5 larger radii.
    let (plan, particles) = pair(3.8, [1.0, 1.5]);
    let forces = [Vector::X, Vector::Y];
    let strain = Traceless([0.0, 1.0, 0.0, 0.0, 0.0]);
    let [with, without] =
        [Some(LubricationRange::default()), None].map(|range| solve(&plan, &particles, &forces, strain, range));
    assert_eq!(with, without);
}

/// Gaussian elimination with pivoting.
fn eliminated(mut matrix: Vec<Vec<f64>>, mut right: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = matrix.len();
    for column in 0..n {
        let pivot = (column..n).max_by(|&i, &j| matrix[i][column].abs().total_cmp(&matrix[j][column].abs())).unwrap();
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        for row in (0..n).filter(|&row| row != column) {
            let factor = matrix[row][column] / matrix[column][column];
            for k in column..n {
                matrix[row][k] -= factor * matrix[column][k];
            }
            for k in 0..right[row].len() {
                right[row][k] -= factor * right[column][k];
            }
        }
    }
    for (i, row) in right.iter_mut().enumerate() {
        for value in row.iter_mut() {
            *value /= matrix[i][i];
        }
    }
    right
}

/// Eleven numbers per particle: velocity, angular velocity and strain rate, or force, torque and moment.
fn flat(linear: &[Vector], angular: &[Vector], tensors: &[Traceless]) -> Vec<f64> {
    let one = |i: usize| [&linear[i].to_array()[..], &angular[i].to_array()[..], &tensors[i].0[..]].concat();
    (0..linear.len()).flat_map(one).collect()
}

/// Resistance matrix of all particles in a box without near images: `M^-1` plus the correction of each pair, column by
/// column.
fn dense(plan: &Plan, particles: &Particles) -> Vec<Vec<f64>> {
    dense_with(plan, particles, |_| 1.0)
}

/// The same with a factor of the correction of each pair.
fn dense_with(plan: &Plan, particles: &Particles, factor: impl Fn([usize; 2]) -> f64) -> Vec<Vec<f64>> {
    let (n, cell) = (particles.len(), plan.cell());
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let mut mobility = Mobility::new(plan, &partition);
    mobility.arrange(&cell, particles);
    let force = PairForce::new(&plan.radii, 1.0, LubricationRange::default()).unwrap();
    let unit = |k: usize| {
        let mut values = vec![[0.0; 11]; n];
        values[k / 11][k % 11] = 1.0;
        let vectors = |from: usize| values.iter().map(|v| Vector::from_slice(&v[from..from + 3])).collect::<Vec<_>>();
        let tensors = values.iter().map(|v| Traceless(std::array::from_fn(|i| v[6 + i]))).collect::<Vec<_>>();
        (vectors(0), vectors(3), tensors)
    };
    let mut columns = vec![vec![0.0; 11 * n]; 11 * n];
    let mut identity = columns.clone();
    for k in 0..11 * n {
        let (forces, torques, moments) = unit(k);
        let stresslets = moments.iter().map(|&d| -d).collect();
        let motion = mobility.apply(&Loads { forces, torques, stresslets }, Output::All);
        let column = flat(&motion.velocities, &motion.angular_velocities, &motion.strain_rates);
        (0..11 * n).for_each(|row| columns[row][k] = column[row]);
        identity[k][k] = 1.0;
    }
    let mut resistance = eliminated(columns, identity);
    let class = |i: usize| plan.radii.iter().position(|a| a.total_cmp(&particles.radii[i]).is_eq()).unwrap() as u32;
    for (i, j) in (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))) {
        let separation = particles.positions[j] - particles.positions[i];
        for k in 11 * i..11 * i + 11 {
            for (moves, k) in [(0, k), (1, k + 11 * (j - i))] {
                let (velocity, angular, strain) = unit(k);
                let mut motion = PairMotion::default();
                let particle = [i, j][moves];
                motion.velocity[moves] = velocity[particle];
                motion.angular_velocity[moves] = angular[particle];
                motion.strain_rate[moves] = strain[particle];
                if let Some(loads) = force.loads(separation, [class(i), class(j)], &motion) {
                    let column = flat(&loads.force, &loads.torque, &loads.moment);
                    for row in 0..22 {
                        resistance[11 * [i, j][row / 11] + row % 11][k] += factor([i, j]) * column[row];
                    }
                }
            }
        }
    }
    resistance
}

fn cluster() -> (Plan, Particles) {
    let radii = [1.0, 1.5, 1.0, 1.0];
    let first = Vector::new(9.0, 8.0, 10.0);
    let second = first + 2.501 * Vector::new(0.6, 0.0, 0.8);
    let positions = [first, second, first + 2.0001 * Vector::new(-0.6, 0.8, 0.0), second + 3.1 * Vector::Y];
    (plan(22.0, &radii, 1e-3, 1e-9), placed(&positions, &radii))
}

#[test]
fn the_iteration_finds_the_dense_solution() {
    let (plan, particles) = cluster();
    let (n, strain) = (particles.len(), Traceless([0.2, 0.5, -0.1, 0.3, 0.0]));
    let forces: Vec<Vector> = (0..n).map(|i| Vector::new(1.0, i as f64, -2.0)).collect();
    let resistance = dense(&plan, &particles);
    let is_motion = |k: &usize| k % 11 < 6;
    let (moving, straining): (Vec<usize>, Vec<usize>) = (0..11 * n).partition(is_motion);
    let ambient = |k: usize| -strain.0[k % 11 - 6];
    let matrix = moving.iter().map(|&i| moving.iter().map(|&j| resistance[i][j]).collect()).collect();
    let right = |&i: &usize| {
        let load = if i % 11 < 3 { forces[i / 11][i % 11] } else { 0.0 };
        vec![load - straining.iter().map(|&k| resistance[i][k] * ambient(k)).sum::<f64>()]
    };
    let motions = eliminated(matrix, moving.iter().map(right).collect());
    let solved = solve(&plan, &particles, &forces, strain, Some(LubricationRange::default()));
    let found = flat(&solved.motion.velocities, &solved.motion.angular_velocities, &solved.stresslets);
    for (&k, exact) in moving.iter().zip(&motions) {
        assert!((found[k] - exact[0]).abs() < 1e-6, "motion {k}: {}, dense {}", found[k], exact[0]);
    }
    for &k in &straining {
        let by_motion: f64 = moving.iter().zip(&motions).map(|(&j, u)| resistance[k][j] * u[0]).sum();
        let exact = -(by_motion + straining.iter().map(|&j| resistance[k][j] * ambient(j)).sum::<f64>());
        assert!((found[k] - exact).abs() < 1e-5 * 20.0, "stresslet {k}: {}, dense {exact}", found[k]);
    }
}

/// A random suspension of squirmers at 30%, solved on ranks that are threads; results in the order of the ids.
fn on_ranks(ranks: usize) -> Vec<f64> {
    let (n, edge) = (24, (24.0 * 4.0 / 3.0 * PI / 0.3_f64).cbrt());
    let (radii, cell) = (vec![1.0; n], cube(edge));
    let positions = random_packing(&cell, &radii, 1e-3, 7).unwrap();
    let plan = plan(edge, &radii, 1e-3, 1e-6);
    let force = PairForce::new(&plan.radii, 1.0, LubricationRange::default()).unwrap();
    SlipForce::new(&force).unwrap();
    let all = Comm::threads(ranks, |comm| {
        let partition = Partition::new(&comm, [plan.grid[1], plan.grid[2]]);
        let mut particles = if comm.is_first() { placed(&positions, &radii) } else { Particles::default() };
        particles.migrate(&partition, &cell);
        let mut fluid =
            CoupledSolver::new(&plan, &partition, lubricated_at(Some(LubricationRange::default()))).unwrap();
        let loads = Loads { forces: vec![Vector::Z; particles.len()], ..Loads::default() };
        let strain = Traceless([0.0, 0.5, 0.0, 0.0, 0.0]);
        let swims = |&id: &u64| domain::Random::new(5, id).point() - Vector::splat(0.5);
        let second = |&id: &u64| Traceless(std::array::from_fn(|k| domain::Random::new(k as u64, id).uniform() - 0.5));
        let squirming = Squirming {
            first: particles.ids.iter().map(swims).collect(),
            second: particles.ids.iter().map(second).collect(),
        };
        let acting = SolveInput { squirming: Some(&squirming), ..acting(&loads, strain) };
        let solved = fluid.solve(&cell, &particles, &acting, Guess::default()).unwrap();
        particles.vectors("velocity").copy_from_slice(&solved.motion.velocities);
        particles.column("stresslet", 5).values.copy_from_slice(bytemuck::cast_slice(&solved.stresslets));
        let mut all = particles.gathered(&partition);
        [
            all.vectors("velocity").iter().flat_map(Vector::to_array).collect(),
            all.column("stresslet", 5).values.to_vec(),
        ]
        .concat()
    });
    all.into_iter().next().unwrap()
}

#[test]
fn ranks_agree() {
    let one = on_ranks(1);
    let scale = one.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    for ranks in [2, 3, 13] {
        let worst = one.iter().zip(on_ranks(ranks)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-10 * scale, "{ranks} ranks: {worst} of {scale}");
    }
}

#[test]
fn a_solution_is_its_own_best_guess() {
    let (plan, particles) = cluster();
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let mut fluid = CoupledSolver::new(&plan, &partition, lubricated_at(Some(LubricationRange::default()))).unwrap();
    let loads = Loads { forces: vec![Vector::Z; particles.len()], ..Loads::default() };
    let strain = Traceless([0.0, 0.5, 0.0, 0.0, 0.0]);
    let first = fluid.solve(&plan.cell(), &particles, &acting(&loads, strain), Guess::default()).unwrap();
    let guess = Guess {
        stresslets_far: first.far.stresslets.clone(),
        induced_velocities: first.induced.velocities.clone(),
        induced_angular_velocities: first.induced.angular_velocities.clone(),
        ..Guess::default()
    };
    let again = fluid.solve(&plan.cell(), &particles, &acting(&loads, strain), guess).unwrap();
    assert!(again.iterations <= 1 && first.iterations > 5, "{} after {}", again.iterations, first.iterations);
}

/// Without the preconditioner a suspension like this takes hundreds of iterations, and more as gaps shrink.
#[test]
fn iterations_are_few_and_do_not_grow_as_gaps_shrink() {
    let (n, edge) = (64, (64.0 * 4.0 / 3.0 * PI / 0.4_f64).cbrt());
    let (radii, cell) = (vec![1.0; n], cube(edge));
    let plan = plan(edge, &radii, 1e-3, 1e-3);
    let mut particles = placed(&random_packing(&cell, &radii, 0.0, 5).unwrap(), &radii);
    let shear = Traceless([0.0, 0.5, 0.0, 0.0, 0.0]);
    let as_packed = solve(&plan, &particles, &[], shear, Some(LubricationRange::default())).iterations;
    // Brings the nearest pair to a gap of 1e-5.
    let apart = |&(i, j): &(usize, usize)| cell.nearest_image(particles.positions[j] - particles.positions[i]).length();
    let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    let (i, j) = pairs.min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
    let line = cell.nearest_image(particles.positions[j] - particles.positions[i]);
    particles.positions[j] -= line * (1.0 - (2.0 + 1e-5) / line.length());
    particles.wrap(&cell);
    let nearer = solve(&plan, &particles, &[], shear, Some(LubricationRange::default())).iterations;
    assert!(as_packed <= 18 && nearer <= as_packed + 2, "{as_packed}, with a near pair {nearer}");
}
