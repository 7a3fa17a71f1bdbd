//! Impossible requests are refused with a message that says why, on all ranks.

use crate::common::{Suspension, on_ranks};
use domain::{Comm, Partition, PeriodicBox, Traceless, Vector};
use fcm::{Fixed, Loads, Method, Motion, Plan, Problem, SolveError, StressletSolver};
use std::sync::Mutex;

fn problem() -> Problem {
    Suspension::random(4, 1.5, PeriodicBox::new(Vector::splat(8.0)).unwrap(), 1).problem(1e-3)
}

fn refusal(problem: &Problem) -> String {
    Plan::choose(problem).unwrap_err().to_string()
}

#[test]
fn no_particles() {
    for radii in [vec![], vec![(1.0, 0)]] {
        let message = refusal(&Problem { radii, ..problem() });
        assert_eq!(message, "there are no particles; a scene needs at least one");
    }
}

#[test]
fn radii_that_are_none() {
    for (radius, text) in [(0.0, "0"), (-1.5, "-1.5"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        let message = refusal(&Problem { radii: vec![(1.0, 2), (radius, 1)], ..problem() });
        assert_eq!(message, format!("a particle has the radius {text}; radii need to be positive and finite"));
    }
}

#[test]
fn particles_larger_than_the_box() {
    for edges in [Vector::new(8.0, 3.0, 8.0), Vector::new(8.0, 8.0, 2.5)] {
        let shortest_vector = edges.min_element();
        let edges_of = Problem { edges, shortest_vector, ..problem() };
        let message = refusal(&edges_of);
        let expected = format!(
            "a particle of radius 1.5 does not fit the box, whose shortest lattice vector is {shortest_vector} long; \
             it needs more than 3"
        );
        assert_eq!(message, expected);
    }
    assert!(Plan::choose(&Problem { edges: Vector::splat(3.01), shortest_vector: 3.01, ..problem() }).is_ok());
}

#[test]
fn tolerances_out_of_range() {
    for (tolerance, text) in [(0.0, "0"), (-0.1, "-0.1"), (0.6, "0.6"), (1e-13, "1e-13"), (f64::NAN, "NaN")] {
        let message = refusal(&Problem { tolerance, ..problem() });
        assert_eq!(message, format!("the tolerance is {text}; it needs to be between 1e-12 and 0.5"));
    }
    for tolerance in [1e-12, 0.5] {
        assert!(Plan::choose(&Problem { tolerance, ..problem() }).is_ok());
    }
}

#[test]
fn grids_that_cannot_be_transformed() {
    for (grid, axis, points, next) in
        [([31, 32, 32], 'x', 31, 32), ([32, 27, 32], 'y', 27, 28), ([32, 32, 0], 'z', 0, 2)]
    {
        let message = refusal(&Problem { fixed: Fixed { grid: Some(grid), ..Fixed::default() }, ..problem() });
        let expected = format!(
            "hydrodynamics.grid: the grid has {points} points along {axis}; it needs an even number; the next one is \
             {next}"
        );
        assert_eq!(message, expected);
    }
}

#[test]
fn boxes_and_fluids_that_are_none() {
    for edge in [0.0, -8.0, f64::NAN, f64::INFINITY] {
        let message = refusal(&Problem { edges: Vector::new(8.0, edge, 8.0), ..problem() });
        assert!(message.starts_with("the box: "), "{message}");
    }
    for (viscosity, text) in [(0.0, "0"), (-1.0, "-1"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        let message = refusal(&Problem { viscosity, ..problem() });
        assert_eq!(message, format!("the viscosity is {text}; it needs to be positive and finite"));
    }
}

#[test]
fn fixed_choices_that_are_none() {
    let refused = |fixed| refusal(&Problem { fixed, ..problem() });
    let message = refused(Fixed { support: Some(0), ..Fixed::default() });
    assert_eq!(message, "hydrodynamics.support is 0; a stencil needs at least 1 point");
    for (width, text) in [(0.0, "0"), (0.8, "0.8"), (f64::NAN, "NaN")] {
        let message = refused(Fixed { width: Some(width), ..Fixed::default() });
        assert_eq!(message, format!("hydrodynamics.width is {text}; it needs to be at least 0.84628"));
    }
    let message = refused(Fixed { cutoff: Some(f64::NAN), ..Fixed::default() });
    assert_eq!(message, "hydrodynamics.cutoff is NaN; it needs to be at least 0");
    for (iteration_tolerance, text) in [(0.0, "0"), (-1e-3, "-0.001"), (f64::NAN, "NaN"), (1.0, "1")] {
        let message = refused(Fixed { iteration_tolerance: Some(iteration_tolerance), ..Fixed::default() });
        let expected = format!("hydrodynamics.iteration_tolerance is {text}; it needs to be above 0 and below 1");
        assert_eq!(message, expected);
    }
}

/// Choices fixed by the user are kept.
#[test]
fn fixed_choices_are_kept() {
    let fixed = Fixed {
        method: Some(Method::Split),
        grid: Some([18, 20, 24]),
        support: Some(10),
        width: Some(1.3),
        cutoff: Some(3.3),
        precision: Some(fcm::Precision::Double),
        device: fcm::ComputeDevice::Cpu,
        iteration_tolerance: Some(1e-5),
    };
    let plan = Plan::choose(&Problem { fixed, ..problem() }).unwrap();
    assert_eq!(plan.split, Some(fcm::Split { width: 1.3, cutoff: 3.3 }));
    assert_eq!((plan.grid, plan.precision), ([18, 20, 24], fcm::Precision::Double));
    assert_eq!((plan.support.lanes, plan.support.support), (16, 10), "whole vectors along x");
    assert!((plan.iteration_tolerance - 1e-5).abs() < 1e-20);
}

/// The expected error is that of the final choice, including the parameters that a user fixed.
#[test]
fn fixed_choices_change_what_is_expected() {
    let expected = |fixed| Plan::choose(&Problem { fixed, ..problem() }).unwrap().predicted_error;
    let split = Fixed { method: Some(Method::Split), width: Some(1.3), ..Fixed::default() };
    let at_best = expected(split);
    for worse in [
        Fixed { grid: Some([6; 3]), ..split },
        Fixed { support: Some(6), ..split },
        Fixed { cutoff: Some(2.6), ..split },
    ] {
        assert!(expected(worse) > 3.0 * at_best, "{worse:?}: {:e} and {at_best:e}", expected(worse));
    }
}

/// The outcome on each of four ranks, of which some own nothing.
fn on_four_ranks(suspension: &Suspension, plan: &Plan, loads: &Loads) -> Vec<Result<(), SolveError>> {
    let outcomes = Mutex::new(Vec::new());
    on_ranks(suspension, plan, [2, 2], loads, |partition, particles, loads| {
        let mut hydrodynamics = StressletSolver::new(plan, partition);
        let strain = Traceless([0.0, 0.5, 0.0, 0.0, 0.0]);
        let outcome = hydrodynamics.solve(&suspension.cell, particles, loads, strain, &[]);
        outcomes.lock().unwrap().push(outcome.map(|_| ()));
        (Motion::default(), Vec::new())
    });
    outcomes.into_inner().unwrap()
}

/// Sixty overlapping spheres: nearly the same flow moves them all, so the system is almost singular.
#[test]
fn a_solve_that_does_not_converge_is_an_error_on_all_ranks() {
    let cell = PeriodicBox::new(Vector::splat(4.0)).unwrap();
    let mut random = domain::Random::new(1, 1);
    let positions = (0..60).map(|_| random.point() * 4.0).collect();
    let suspension = Suspension { cell, viscosity: 1.0, positions, radii: vec![1.0; 60] };
    let plan = suspension.plan(1e-2, Fixed { iteration_tolerance: Some(1e-12), ..Fixed::default() });
    let outcomes = on_four_ranks(&suspension, &plan, &suspension.loads(1));
    assert_eq!(outcomes.len(), 4);
    assert!(outcomes.windows(2).all(|o| o[0] == o[1]), "one answer for all: {outcomes:?}");
    let Err(error @ SolveError::NotConverged { iterations, residual, .. }) = &outcomes[0] else {
        panic!("not refused: {outcomes:?}")
    };
    assert!(*iterations > 100 && *residual > 1e-12);
    let expected = format!(
        "the stresslets did not converge: after {iterations} iterations the residual is {residual:.1e}, asked for \
         1.0e-12; allow a larger hydrodynamics.iteration_tolerance, or look for overlapping particles"
    );
    assert_eq!(error.to_string(), expected);
}

#[test]
fn loads_that_are_not_numbers_are_an_error_on_all_ranks() {
    let suspension = Suspension::random(3, 1.2, PeriodicBox::new(Vector::splat(7.0)).unwrap(), 2);
    for method in [Method::Direct, Method::Split] {
        let plan = suspension.plan(1e-2, Fixed { method: Some(method), ..Fixed::default() });
        for bad in [f64::NAN, f64::INFINITY] {
            let mut loads = suspension.loads(1);
            loads.forces[1].y = bad;
            let outcomes = on_four_ranks(&suspension, &plan, &loads);
            assert_eq!(outcomes, vec![Err(SolveError::NotFinite); 4], "{method:?}");
        }
    }
    let expected = "the motion of the particles is not finite; look for forces beyond the range of numbers \
        (species.force, repulsion.strength, ...), or for particles at one point";
    assert_eq!(SolveError::NotFinite.to_string(), expected);
}

/// Two particles at one point move alike; that is no error, since envelopes may overlap.
#[test]
fn particles_at_one_point_have_a_motion() {
    let cell = PeriodicBox::new(Vector::splat(7.0)).unwrap();
    let suspension = Suspension { cell, viscosity: 1.0, positions: vec![Vector::splat(1.0); 2], radii: vec![1.0; 2] };
    for method in [Method::Direct, Method::Split] {
        let plan = suspension.plan(1e-4, Fixed { method: Some(method), ..Fixed::default() });
        let mut hydrodynamics =
            StressletSolver::new(&plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
        let loads = Loads { forces: vec![Vector::X; 2], ..Loads::default() };
        let strain = Traceless([0.0, 0.5, 0.0, 0.0, 0.0]);
        let solved = hydrodynamics.solve(&cell, &suspension.particles(), &loads, strain, &[]).unwrap();
        let [a, b] = [solved.motion.velocities[0], solved.motion.velocities[1]];
        assert!((a - b).length() < 1e-4 * a.length());
    }
}
