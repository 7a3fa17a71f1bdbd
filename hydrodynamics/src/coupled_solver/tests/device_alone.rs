//! Spheres without lubrication by the kernels of a card, which an emulator runs on the host, against the solve of the
//! host. Their solutions stay on the card.

use super::on_device::{Suspension, columns, emulator, relative};
use super::*;
use domain::Boundaries;
use gpu::{Counted, Device};

/// Loads by which spheres settle and rotate.
fn loads(particles: &Particles) -> Loads {
    Loads {
        forces: particles.radii.iter().map(|a| Vector::new(0.2, 0.0, -a.powi(3))).collect(),
        torques: particles.radii.iter().map(|a| Vector::new(0.0, 0.3 * a.powi(3), 0.1)).collect(),
        stresslets: Vec::new(),
    }
}

fn on_card(suspension: &Suspension, device: Box<dyn Device>) -> CoupledSolver {
    suspension.with_range(device, ShortRange::default())
}

fn on_host(suspension: &Suspension) -> CoupledSolver {
    CoupledSolver::new(&suspension.plan, &suspension.partition(), ShortRange::default()).unwrap()
}

/// Solutions in a flow, then of spheres that settle in it, from the first as a guess.
fn solutions(suspension: &Suspension, flow: StrainRate, mut solver: CoupledSolver) -> [Solution; 2] {
    let Suspension { cell, particles, .. } = suspension;
    let mut solved = |loads: &Loads, guess: Guess| {
        let input = SolveInput { keeps_columns: true, ..SolveInput::new(loads, flow) };
        let solution = solver.solve(cell, particles, &input, guess).unwrap();
        solver.with_lists(solution, particles)
    };
    let first = solved(&Loads::default(), Guess::default());
    let guess = Guess { stresslets_far: first.far.stresslets.clone(), ..Guess::default() };
    [first, solved(&loads(particles), guess)]
}

/// Motions and stresslets have errors of at most three times the tolerance, in no more iterations than on the host but
/// for two, by kernels of solves with near pairs.
fn agree(suspension: &Suspension, flow: StrainRate) {
    let tolerance = suspension.plan.iteration_tolerance;
    let exact = solutions(suspension, flow, on_host(&suspension.with_tolerance(1e-2 * tolerance)));
    let of_host = solutions(suspension, flow, on_host(suspension));
    let (device, counts) = Counted::new(emulator(3));
    let found = solutions(suspension, flow, on_card(suspension, Box::new(device)));
    assert!(counts.borrow().runs.keys().all(|kernel| !kernel.starts_with("strain_")), "{:?}", counts.borrow().runs);
    for ((found, of_host), exact) in found.iter().zip(&of_host).zip(&exact) {
        assert!(found.iterations > 2 && found.iterations <= of_host.iterations + 2, "{}", found.iterations);
        let ([v, w, .., far, all], exact) = (columns(found), columns(exact));
        for (found, exact) in [v, w, far, all].iter().zip([&exact[0], &exact[1], &exact[4], &exact[5]]) {
            let error = relative(found, exact);
            assert!(error < 3.0 * tolerance, "{error:e} at a tolerance of {tolerance:e}");
        }
    }
}

#[test]
fn solutions_in_shear_are_those_of_the_host() {
    let sheared = |edge| PeriodicBox::sheared(Vector::splat(edge), 0.3).unwrap();
    let flow = StrainRate::uniform(Traceless([0.0, 0.5, 0.0, 0.0, 0.0]));
    for (precision, tolerance) in [(Precision::Double, 1e-6), (Precision::Single, 1e-4)] {
        agree(&Suspension::within(sheared, precision, tolerance), flow);
    }
}

/// In a flow whose strain rate changes across the walls, and in one around spheres in unbounded fluid.
#[test]
fn solutions_at_walls_and_in_the_open_are_those_of_the_host() {
    let uniform = Traceless([0.1, 0.0, 0.2, -0.2, 0.3]);
    for (boundaries, slope) in [(Boundaries::Walls, [0.05, 0.04]), (Boundaries::Open, [0.0; 2])] {
        let within = |edge| PeriodicBox::new(Vector::splat(edge)).unwrap().with_boundaries(boundaries).unwrap();
        let suspension = Suspension::within(within, Precision::Double, 1e-5);
        agree(&suspension, StrainRate { at_zero: uniform, slope });
    }
}
