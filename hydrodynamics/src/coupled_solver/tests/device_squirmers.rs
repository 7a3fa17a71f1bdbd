//! Squirmers by the kernels of a card, which an emulator runs on the host, against the solve of the host.

use super::on_device::{Suspension, agree_in, columns, emulator, relative};
use super::*;
use domain::{Boundaries, Random};
use fcm::{Mobility, StressletSolver};
use gpu::Counted;

/// Squirmers with both modes along random axes among passive spheres.
fn squirming(particles: &Particles) -> Squirming {
    let mut numbers = Random::new(5, 0);
    let mut slip = Squirming::default();
    for row in 0..particles.len() {
        let axis = Vector::from_array(std::array::from_fn(|_| numbers.uniform() - 0.5)).normalize();
        let (first, second) = if row % 3 == 2 { (0.0, 0.0) } else { (0.8, -1.5) };
        let Vector { x, y, z } = axis;
        let third = 1.0 / 3.0;
        slip.first.push(axis * first);
        slip.second.push(Traceless([x * x - third, x * y, x * z, y * y - third, y * z]) * second);
    }
    slip
}

/// Solutions of squirmers in shear, then of ones that settle in an ambient flow.
fn solutions(suspension: &Suspension, mut solver: CoupledSolver) -> [Solution; 2] {
    let Suspension { cell, particles, .. } = suspension;
    let (slip, none) = (squirming(particles), Loads::default());
    let shear = acting(&none, Traceless([0.0, 0.5, 0.0, 0.0, 0.0]));
    let swimming = SolveInput { squirming: Some(&slip), ..shear };
    let first = solver.solve(cell, particles, &swimming, Guess::default()).unwrap();
    let forces = particles.radii.iter().map(|a| Vector::new(0.3, 0.0, -a.powi(3))).collect();
    let loads = Loads { forces, ..Loads::default() };
    let of_one = |row: usize| Vector::new(0.1, -0.02 * row as f64, 0.0);
    let velocities: Vec<Vector> = (0..particles.len()).map(of_one).collect();
    let angular_velocities = velocities.iter().map(|&v| 0.5 * v).collect();
    let strain_rates = vec![Traceless([0.02, 0.1, 0.0, -0.05, 0.0]); particles.len()];
    let ambient = Motion { velocities, angular_velocities, strain_rates };
    let settling = SolveInput { squirming: Some(&slip), ambient: &ambient, ..acting(&loads, Traceless::ZERO) };
    let guess = Guess { stresslets_far: first.far.stresslets.clone(), ..Guess::induced_by(&first.motion) };
    [first, solver.solve(cell, particles, &settling, guess).unwrap()]
}

#[test]
fn solutions_are_those_of_the_host() {
    let sheared = |edge| PeriodicBox::sheared(Vector::splat(edge), 0.3).unwrap();
    for (precision, tolerance) in [(Precision::Double, 1e-4), (Precision::Single, 1e-4)] {
        let suspension = Suspension::within(sheared, precision, tolerance);
        agree_in(&suspension, |solver| solutions(&suspension, solver));
    }
}

/// Slip between near spheres and at walls exerts loads, which the host adds up.
#[test]
fn solutions_between_walls_are_those_of_the_host() {
    let walls = |edge| PeriodicBox::new(Vector::splat(edge)).unwrap().with_boundaries(Boundaries::Walls).unwrap();
    let suspension = Suspension::within(walls, Precision::Double, 1e-4);
    agree_in(&suspension, |solver| solutions(&suspension, solver));
}

/// The iteration is on the card: kernels of coupled solves run in each.
#[test]
fn iterations_stay_on_the_device() {
    let sheared = |edge| PeriodicBox::sheared(Vector::splat(edge), 0.3).unwrap();
    let suspension = Suspension::within(sheared, Precision::Single, 1e-3);
    let (device, counts) = Counted::new(emulator(5));
    let [first, second] = solutions(&suspension, suspension.on(Box::new(device)));
    let iterations = (first.iterations + second.iterations) as u64;
    assert_eq!(counts.borrow().runs["coupled_image_f32"], iterations + 2);
}

/// Without lubrication the slip acts by ambient motions alone.
#[test]
fn squirmers_without_lubrication_are_those_of_the_host() {
    let sheared = |edge| PeriodicBox::sheared(Vector::splat(edge), 0.3).unwrap();
    let suspension = Suspension::within(sheared, Precision::Double, 1e-6);
    let partition = suspension.partition();
    let solved = |far: StressletSolver| {
        let mut solver = CoupledSolver::of(far, &partition, ShortRange::default()).unwrap();
        let (slip, none) = (squirming(&suspension.particles), Loads::default());
        let shear = acting(&none, Traceless([0.0, 0.5, 0.0, 0.0, 0.0]));
        let input = SolveInput { squirming: Some(&slip), keeps_columns: true, ..shear };
        let solution = solver.solve(&suspension.cell, &suspension.particles, &input, Guess::default()).unwrap();
        assert!(solution.iterations > 3);
        solver.with_lists(solution, &suspension.particles)
    };
    let on_card = Mobility::on(emulator(3), &suspension.plan, &partition);
    let found = solved(StressletSolver::of(on_card, partition.comm()));
    let exact = solved(StressletSolver::new(&suspension.with_tolerance(1e-8).plan, &partition));
    let [found, exact] = [&found, &exact].map(columns);
    for kind in [0, 1, 4, 5] {
        assert!(relative(&found[kind], &exact[kind]) < 3e-6, "{:e}", relative(&found[kind], &exact[kind]));
    }
}
