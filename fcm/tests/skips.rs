//! Work that a scene does not need is skipped: checks counters of work, not timings.

use crate::common::{self, Suspension};
use domain::{Comm, Partition, PeriodicBox, Traceless, Vector};
use fcm::{Fixed, Loads, Method, Mobility, Multipoles, Output, Plan, Problem, StressletSolver, Work};

const COUNT: usize = 10;

fn suspension() -> Suspension {
    Suspension::random(COUNT, 1.5, PeriodicBox::new(Vector::splat(9.0)).unwrap(), 1)
}

fn fixed(method: Method) -> Fixed {
    Fixed { method: Some(method), ..Fixed::default() }
}

fn mobility(suspension: &Suspension, method: Method) -> Mobility {
    suspension.mobility(&suspension.plan(1e-2, fixed(method)))
}

/// Work of one evaluation.
fn work(mobility: &mut Mobility, loads: &Loads, output: Output) -> Work {
    let before = mobility.work();
    mobility.apply(loads, output);
    let after = mobility.work();
    Work {
        evaluations: after.evaluations - before.evaluations,
        particles_spread: after.particles_spread - before.particles_spread,
        dipole_spreads: after.dipole_spreads - before.dipole_spreads,
        dipole_interpolations: after.dipole_interpolations - before.dipole_interpolations,
        transforms: after.transforms - before.transforms,
        neighbours: after.neighbours - before.neighbours,
        searches: after.searches - before.searches,
        seconds: after.seconds - before.seconds,
    }
}

const METHODS: [Method; 2] = [Method::Direct, Method::Split];

#[test]
fn an_evaluation_of_everything_does_everything_once() {
    let suspension = suspension();
    for method in METHODS {
        let done = work(&mut mobility(&suspension, method), &suspension.loads(1), Output::All);
        assert_eq!((done.evaluations, done.transforms), (1, 1));
        assert_eq!(done.particles_spread, COUNT as u64);
        assert_eq!((done.dipole_spreads, done.dipole_interpolations), (1, 1));
        assert_eq!(done.neighbours > 0, method == Method::Split);
    }
}

#[test]
fn monopoles_alone_never_touch_a_dipole() {
    let suspension = suspension();
    let loads = suspension.loads(1);
    for method in METHODS {
        let multipoles = Multipoles::Monopole;
        let problem = Problem { multipoles, fixed: fixed(method), ..suspension.problem(1e-2) };
        let plan = Plan::choose(&problem).unwrap();
        let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
        let mut hydrodynamics = StressletSolver::new(&plan, &partition);
        let particles = suspension.particles();
        let background = Traceless([0.1; 5]);
        // Torques, stresslets and the background are given, but monopoles do not respond to them.
        let solved = hydrodynamics.solve(&suspension.cell, &particles, &loads, background, &[]).unwrap();
        let done = hydrodynamics.work();
        assert_eq!((done.evaluations, done.transforms, done.particles_spread), (1, 1, COUNT as u64));
        assert_eq!((done.dipole_spreads, done.dipole_interpolations), (0, 0));
        assert!(solved.stresslets.is_empty() && solved.motion.angular_velocities.is_empty());
        assert_eq!((solved.iterations, solved.motion.velocities.len()), (0, COUNT));
    }
}

#[test]
fn particles_without_loads_are_not_spread() {
    let suspension = suspension();
    for method in METHODS {
        let mut mobility = mobility(&suspension, method);
        let mut loads = suspension.loads(1);
        for n in 0..4 {
            loads.forces[n] = Vector::ZERO;
            loads.torques[n] = Vector::ZERO;
            loads.stresslets[n] = Traceless::ZERO;
        }
        // A particle with only a torque left is spread.
        loads.torques[3] = Vector::X;
        assert_eq!(work(&mut mobility, &loads, Output::All).particles_spread, COUNT as u64 - 3);
        assert_eq!(work(&mut mobility, &Loads::default(), Output::All).particles_spread, 0);
    }
}

/// Leaving out zeros changes nothing: the bits are those of loads that list their zeros.
#[test]
fn lists_of_zeros_and_no_lists_are_the_same_loads() {
    let suspension = suspension();
    for method in METHODS {
        let mut mobility = mobility(&suspension, method);
        let forces = suspension.loads(1).forces;
        let none = Loads { forces: forces.clone(), ..Loads::default() };
        let zeros = Loads { forces, torques: vec![Vector::ZERO; COUNT], stresslets: vec![Traceless::ZERO; COUNT] };
        let (a, b) = (mobility.apply(&none, Output::All), mobility.apply(&zeros, Output::All));
        let scale = a.velocities.iter().map(|v| v.length()).fold(0.0, f64::max);
        let same = a.velocities.iter().zip(&b.velocities).all(|(v, w)| (*v - *w).length() <= 1e-6 * scale);
        assert!(same, "the grid is in f32, with 6e-8 of round-off");
        let moved = work(&mut mobility, &none, Output::All);
        assert_eq!((moved.dipole_spreads, moved.dipole_interpolations), (0, 1));
    }
}

#[test]
fn velocities_alone_need_no_gradient_and_torque_free_particles_no_dipole() {
    let suspension = suspension();
    let all = suspension.loads(1);
    for method in METHODS {
        let mut mobility = mobility(&suspension, method);
        let forces = Loads { forces: all.forces.clone(), ..Loads::default() };
        let done = work(&mut mobility, &forces, Output::Velocities);
        assert_eq!((done.dipole_spreads, done.dipole_interpolations), (0, 0));
        let done = work(&mut mobility, &forces, Output::Gradients);
        assert_eq!((done.dipole_spreads, done.dipole_interpolations), (0, 1));
        let done = work(&mut mobility, &all, Output::Velocities);
        assert_eq!((done.dipole_spreads, done.dipole_interpolations), (1, 0));
    }
}

/// Outputs evaluated alone have the same values as among all.
#[test]
fn parts_of_an_evaluation_agree_with_the_whole() {
    let suspension = suspension();
    let loads = suspension.loads(1);
    for method in METHODS {
        let mut mobility = mobility(&suspension, method);
        let all = mobility.apply(&loads, Output::All);
        let velocities = mobility.apply(&loads, Output::Velocities);
        let gradients = mobility.apply(&loads, Output::Gradients);
        assert!(velocities.angular_velocities.is_empty() && velocities.strain_rates.is_empty());
        assert!(gradients.velocities.is_empty());
        let together = fcm::Motion { velocities: velocities.velocities, ..gradients };
        assert!(common::worst(&together, &all) < 1e-6, "the grid is in f32");
    }
}

#[test]
fn the_direct_method_looks_for_no_neighbours() {
    let suspension = suspension();
    let mut mobility = mobility(&suspension, Method::Direct);
    mobility.arrange(&suspension.cell, &suspension.particles());
    mobility.apply(&suspension.loads(1), Output::All);
    assert_eq!((mobility.work().searches, mobility.work().neighbours), (0, 0));
}

#[test]
fn neighbours_are_searched_once_for_any_number_of_evaluations() {
    let suspension = suspension();
    let mut mobility = mobility(&suspension, Method::Split);
    let first = work(&mut mobility, &suspension.loads(1), Output::All);
    let second = work(&mut mobility, &suspension.loads(2), Output::All);
    assert_eq!((first.neighbours, second.searches), (second.neighbours, 0));
    assert_eq!(mobility.work().searches, 1);
}

/// Steps that are small against the cutoff share a search, after the first two: the first search has no skin.
#[test]
fn neighbours_are_not_searched_for_while_nobody_has_moved_far() {
    let suspension = suspension();
    let mut mobility = mobility(&suspension, Method::Split);
    for turn in 1..6 {
        let mut particles = suspension.particles();
        for x in &mut particles.positions {
            *x = suspension.cell.wrap(*x + Vector::splat(1e-3 * f64::from(turn))).0;
        }
        mobility.arrange(&suspension.cell, &particles);
    }
    assert_eq!(mobility.work().searches, 2);
}

/// Particles that have not moved are arranged once. The motions have the same bits as with a second arrangement.
#[test]
fn particles_at_rest_are_arranged_once() {
    for method in [Method::Split, Method::Direct] {
        let suspension = suspension();
        let (mut twice, mut once) = (mobility(&suspension, method), mobility(&suspension, method));
        let mut particles = suspension.particles();
        for _ in 0..2 {
            twice.arrange(&suspension.cell, &particles);
            once.follow(&suspension.cell, &particles);
            let before = once.work().seconds;
            once.follow(&suspension.cell, &particles);
            assert_eq!(once.work().seconds, before, "nothing is done");
            let loads = suspension.loads(1);
            assert_eq!(twice.apply(&loads, Output::All), once.apply(&loads, Output::All));
            particles.positions[0] += Vector::splat(1e-3);
        }
    }
}

#[test]
fn a_cutoff_below_the_nearest_pair_visits_none() {
    let suspension = suspension();
    let nothing = Fixed { cutoff: Some(1e-3), ..fixed(Method::Split) };
    let mut mobility = suspension.mobility(&suspension.plan(1e-2, nothing));
    assert_eq!(work(&mut mobility, &suspension.loads(1), Output::All).neighbours, 0);
}

/// Each pair is visited from both its particles, and pairs beyond the cutoff are not visited: the number is that of a
/// plain count.
#[test]
fn neighbours_are_those_within_the_cutoff() {
    let suspension = suspension();
    let mut mobility = mobility(&suspension, Method::Split);
    let cutoff = mobility.plan().cutoff();
    let mut count = 0;
    for (n, &p) in suspension.positions.iter().enumerate() {
        for (m, &q) in suspension.positions.iter().enumerate() {
            for image in 0..7_i32.pow(3) {
                let steps = [image % 7 - 3, image / 7 % 7 - 3, image / 49 - 3];
                let is_itself = n == m && steps == [0; 3];
                count += u64::from(!is_itself && (p - q + suspension.cell.lattice(steps)).length() < cutoff);
            }
        }
    }
    assert_eq!(work(&mut mobility, &suspension.loads(1), Output::All).neighbours, count);
}

/// Each iteration is one evaluation and one pass over the grid, in addition to the first for forces and torques.
#[test]
fn an_iteration_costs_one_evaluation() {
    let suspension = suspension();
    let plan = suspension.plan(1e-3, Fixed::default());
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let mut hydrodynamics = StressletSolver::new(&plan, &partition);
    let (particles, loads) = (suspension.particles(), suspension.loads(1));
    let solved = hydrodynamics.solve(&suspension.cell, &particles, &loads, Traceless::ZERO, &[]).unwrap();
    let done = hydrodynamics.work();
    assert_eq!((done.evaluations, done.transforms), (solved.iterations as u64 + 1, solved.iterations as u64 + 1));
    assert!(done.searches <= 1);
}
