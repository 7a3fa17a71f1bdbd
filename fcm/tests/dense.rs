//! The dense method: exact, on any number of ranks, and within the tolerance of the methods with a grid.

use crate::common::{Suspension, error, on_ranks, rigid_errors, solved, tensors, vectors, worst};
use domain::{Boundaries, Comm, Partition, PeriodicBox, Random, Traceless, Vector};
use fcm::{
    ComputeDevice, Fixed, Loads, Method, Mobility, Motion, Multipoles, Output, Plan, Problem, Stream, StressletSolver,
};

const DENSE: Fixed = Fixed {
    method: Some(Method::Dense),
    grid: None,
    support: None,
    width: None,
    cutoff: None,
    precision: None,
    device: ComputeDevice::Cpu,
    iteration_tolerance: None,
};

/// Loads of one kind at a time, and all together.
fn kinds(all: Loads) -> [Loads; 4] {
    [
        Loads { forces: all.forces.clone(), ..Loads::default() },
        Loads { torques: all.torques.clone(), ..Loads::default() },
        Loads { stresslets: all.stresslets.clone(), ..Loads::default() },
        all,
    ]
}

/// All components as one list, with those that vanish by symmetry measured against the others.
fn components(motion: &Motion) -> Vec<f64> {
    [vectors(&motion.velocities), vectors(&motion.angular_velocities), tensors(&motion.strain_rates)].concat()
}

fn off(found: &Motion, exact: &Motion) -> f64 {
    error(&components(found), &components(exact))
}

#[test]
fn entries_are_those_of_a_sum_over_all_wavevectors() {
    for (edges, strain, ratio) in [([7.0, 7.0, 7.0], 0.0, 1.0), ([6.0, 7.5, 9.0], -0.35, 1.8)] {
        let cell = PeriodicBox::sheared(Vector::from_array(edges), strain).unwrap();
        let suspension = Suspension::random(5, ratio, cell, 3);
        let mut mobility = suspension.mobility(&suspension.plan(1e-3, DENSE));
        for loads in kinds(suspension.loads(5)) {
            let found = mobility.apply(&loads, Output::All);
            let exact = suspension.motion(&loads);
            assert!(off(&found, &exact) < 2e-13, "{ratio}: {:e}", off(&found, &exact));
        }
    }
}

/// Random cases: radii up to 1:4, upright, sheared and tilted boxes, all kinds of loads.
#[test]
fn methods_with_a_grid_agree_with_it_to_the_tolerance() {
    let mut random = Random::new(17, 0);
    for case in 0..12 {
        let mut number = |low: f64, high: f64| low + (high - low) * random.uniform();
        let (tolerance, ratio) = (10_f64.powf(number(-8.0, -3.0)), number(1.0, 4.0));
        let edge = 3.2 * ratio + number(1.0, 5.0);
        let edges = Vector::new(edge, edge * number(1.0, 1.3), edge * number(1.0, 1.3));
        let strain = number(-0.45, 0.45);
        let [x, y, z] = [edges.x, edges.y, edges.z];
        let tilted = [
            Vector::new(x, 0.0, 0.0),
            Vector::new(strain * y, y, 0.0),
            Vector::new(number(-0.3, 0.3) * z, number(-0.3, 0.3) * z, z),
        ];
        let cell = match case % 3 {
            0 => PeriodicBox::new(edges).unwrap(),
            1 => PeriodicBox::sheared(edges, strain).unwrap(),
            _ => PeriodicBox::of_lattice(tilted).unwrap(),
        };
        let suspension = Suspension::random(6, ratio, cell, case);
        let mut exact = suspension.mobility(&suspension.plan(tolerance, DENSE));
        let mut grid = suspension.mobility(&suspension.plan(tolerance, Fixed::default()));
        for (kind, loads) in kinds(suspension.loads(case)).iter().enumerate() {
            let [found, exact] = [&mut grid, &mut exact].map(|mobility| mobility.apply(loads, Output::All));
            assert!(off(&found, &exact) < tolerance, "{case}, {kind}: {:e} for {tolerance:e}", off(&found, &exact));
        }
    }
}

#[test]
fn rigid_spheres_keep_the_tolerance() {
    let suspension = Suspension::random(8, 1.5, PeriodicBox::new(Vector::splat(8.0)).unwrap(), 4);
    let loads = Loads { stresslets: Vec::new(), ..suspension.loads(3) };
    let plan = suspension.plan(1e-6, DENSE);
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let mut solver = StressletSolver::new(&plan, &partition);
    let found = solver.solve(&suspension.cell, &suspension.particles(), &loads, Traceless::ZERO, &[]).unwrap();
    let grid = solved(&suspension, &loads, 1e-6);
    let errors = rigid_errors(&found, &grid);
    assert!(errors.iter().all(|&error| error < 1e-6), "{errors:?}");
}

#[test]
fn any_number_of_ranks_gives_the_same_digits_and_noise() {
    let cell = PeriodicBox::sheared(Vector::new(9.0, 8.0, 10.0), 0.2).unwrap();
    let suspension = Suspension::random(9, 1.6, cell, 8);
    let plan = suspension.plan(1e-3, DENSE);
    for is_random in [false, true] {
        let on = |table: [usize; 2]| {
            let answer = |partition: &Partition, particles: &domain::Particles, loads: &Loads| {
                let mut mobility = Mobility::new(&plan, partition);
                mobility.arrange(&suspension.cell, particles);
                let noise = |mobility: &mut Mobility| mobility.noise(&particles.ids, 1e-3, Stream::new(5, 1)).0;
                let motion = if is_random { noise(&mut mobility) } else { mobility.apply(loads, Output::All) };
                (motion, vec![Traceless::ZERO; particles.len()])
            };
            on_ranks(&suspension, &plan, table, &suspension.loads(2), answer).0
        };
        let alone = on([1, 1]);
        for table in [[1, 2], [2, 2], [3, 5]] {
            let found = on(table);
            assert!(worst(&found, &alone) < 1e-12, "{is_random} on {table:?}: {:e}", worst(&found, &alone));
        }
    }
}

/// Columns are in the order of ids, so the order of the particles does not matter; nor do units that are powers of
/// two, to the last bit.
#[test]
fn order_and_units_change_no_bit() {
    let suspension = Suspension::random(5, 1.4, PeriodicBox::new(Vector::splat(6.0)).unwrap(), 2);
    let loads = suspension.loads(1);
    let plan = suspension.plan(1e-3, DENSE);
    let found = suspension.evaluate(&plan, &loads);
    let mut particles = suspension.particles().selected(&[3, 0, 4, 2, 1]);
    let picked = |list: &[Vector]| [3, 0, 4, 2, 1].map(|row| list[row]).to_vec();
    let mut mobility = Mobility::new(&plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
    mobility.arrange(&suspension.cell, &particles);
    let stresslets = [3, 0, 4, 2, 1].map(|row| loads.stresslets[row]).to_vec();
    let mixed = Loads { forces: picked(&loads.forces), torques: picked(&loads.torques), stresslets };
    assert_eq!(mobility.apply(&mixed, Output::All).velocities, picked(&found.velocities));
    let large = Suspension {
        cell: suspension.cell.scaled(4.0),
        positions: suspension.positions.iter().map(|&x| x * 4.0).collect(),
        radii: suspension.radii.iter().map(|a| a * 4.0).collect(),
        ..suspension
    };
    let forces = Loads { forces: loads.forces, ..Loads::default() };
    let before = mobility.apply(&Loads { forces: picked(&forces.forces), ..Loads::default() }, Output::Velocities);
    let after = large.evaluate(&large.plan(1e-3, DENSE), &forces);
    let quarter: Vec<Vector> = before.velocities.iter().map(|&v| v * 0.25).collect();
    assert_eq!(quarter, picked(&after.velocities));
    // Entries are found again only if particles move.
    let seconds = mobility.work().seconds.near;
    mobility.arrange(&PeriodicBox::new(Vector::splat(6.0)).unwrap(), &particles);
    assert!(mobility.work().seconds.near <= seconds);
    particles.positions[0].x += 1e-3;
    mobility.arrange(&PeriodicBox::new(Vector::splat(6.0)).unwrap(), &particles);
    assert!(mobility.work().seconds.near > seconds);
}

/// Along loads of any kind the variance of draws is that of the mobility: within 4.5 standard errors.
#[test]
fn draws_have_the_covariance_of_the_mobility() {
    let suspension = Suspension::random(4, 1.5, PeriodicBox::new(Vector::splat(6.0)).unwrap(), 5);
    for multipoles in [Multipoles::Monopole, Multipoles::Dipole] {
        let plan = Plan::choose(&Problem { fixed: DENSE, multipoles, ..suspension.problem(1e-3) }).unwrap();
        let mut mobility = suspension.mobility(&plan);
        let draws: Vec<Motion> =
            (0..1000).map(|number| mobility.noise(&[0, 1, 2, 3], 1e-3, Stream::new(3, number)).0).collect();
        for seed in 0..4 {
            let (mut loads, mut output) = (suspension.loads(seed), Output::All);
            if multipoles == Multipoles::Monopole {
                (loads.torques, loads.stresslets, output) = (Vec::new(), Vec::new(), Output::Velocities);
            }
            let exact = mobility.apply(&loads, output).power(&loads);
            let found = draws.iter().map(|motion| motion.power(&loads).powi(2)).sum::<f64>() / 1000.0;
            assert!((found / exact - 1.0).abs() < 4.5 * (2.0_f64 / 1000.0).sqrt(), "{multipoles:?}: {found}, {exact}");
        }
    }
}

#[test]
fn it_is_refused_where_it_does_not_fit() {
    let suspension = Suspension::random(3, 1.2, PeriodicBox::new(Vector::splat(8.0)).unwrap(), 5);
    let refusal = |problem: Problem| Plan::choose(&problem).unwrap_err().to_string();
    let problem = || Problem { fixed: DENSE, ..suspension.problem(1e-3) };
    let walls = refusal(Problem { boundaries: Boundaries::Walls, ..problem() });
    assert!(walls.contains("hydrodynamics.method \"dense\" is for boxes that repeat along all axes"), "{walls}");
    let many = refusal(Problem { radii: vec![(0.1, 2000)], ..problem() });
    assert!(many.contains("for 2000 spheres; it is for 1489 spheres at most"), "{many}");
    let grid = refusal(Problem { fixed: Fixed { grid: Some([16; 3]), ..DENSE }, ..problem() });
    assert!(grid.contains("hydrodynamics.grid is set, but hydrodynamics.method is \"dense\""), "{grid}");
    let plan = suspension.plan(1e-3, DENSE);
    assert!(plan.describe().starts_with("method     dense: matrix of exact sums over all pairs in f64\ntolerance "));
    assert_eq!(suspension.plan(1e-3, Fixed::default()).method, Method::Split);
}
