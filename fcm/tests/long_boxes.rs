//! Sheared boxes that are long along the flow, flat or slender: their strain is up to half the aspect ratio.

use crate::common::{Suspension, on_ranks, worst};
use domain::{PeriodicBox, Random, Vector};
use fcm::{Fixed, Mobility, Output, Plan, Precision};

/// A few particles of radii from 1 to at most 2 in a box four to a hundred times as long as it is wide, at any strain
/// of its range.
fn random_case(name: u64) -> Suspension {
    let mut random = Random::new(23, name);
    let ratio = if name.is_multiple_of(2) { 1.0 } else { 1.0 + random.uniform() };
    let across = 2.2 * ratio * (1.0 + random.uniform());
    let aspect = 4.0 * 25f64.powf(random.uniform());
    let height = across * 3f64.powf(random.uniform());
    let edges = Vector::new(across * aspect, across, height);
    let strain = (random.uniform() - 0.5) * edges.x / edges.y;
    let most = 0.4 * edges.element_product() / (4.2 * ratio.powi(3));
    let count = (2.0 + (0.2 * aspect + 6.0) * random.uniform()).min(most).max(1.0) as usize;
    Suspension::random(count, ratio, PeriodicBox::sheared(edges, strain).unwrap(), name)
}

/// Error and plan at a tolerance, for any strain of the box.
fn error(suspension: &Suspension, seed: u64, tolerance: f64) -> (f64, Plan) {
    let (loads, edges) = (suspension.loads(seed), suspension.cell.edges());
    let problem = fcm::Problem { largest_strain: 0.5 * edges.x / edges.y, ..suspension.problem(tolerance) };
    let plan = Plan::choose(&problem).unwrap();
    (worst(&suspension.evaluate(&plan, &loads), &suspension.motion(&loads)), plan)
}

/// With grid points at which the Gaussian factor along the lattice underflows by itself.
#[test]
fn equal_spheres_move_in_boxes_up_to_sixty_times_as_long_as_wide() {
    for (aspect, part) in [(16.0, 0.49), (20.0, 0.3), (20.0, -0.5), (40.0, 0.2), (60.0, 0.1)] {
        let edges = Vector::new(4.0 * aspect, 4.0, 4.0);
        let cell = PeriodicBox::sheared(edges, part * aspect).unwrap();
        let suspension = Suspension::random((0.2 * aspect) as usize, 1.0, cell, 4);
        for tolerance in [1e-1, 1e-3, 1e-8] {
            let (error, plan) = error(&suspension, 1, tolerance);
            assert!(error < tolerance, "{aspect} at {part}: {error:e} at {tolerance:e} by {plan:?}");
        }
    }
}

#[test]
#[ignore = "heavy"]
fn errors_are_below_the_tolerance_in_long_boxes() {
    let mut random = Random::new(29, 0);
    for name in 0..40 {
        let suspension = random_case(name);
        for _ in 0..3 {
            let tolerance = 10f64.powf(-1.0 - 9.0 * random.uniform());
            let (error, plan) = error(&suspension, name, tolerance);
            assert!(error < tolerance, "case {name}: {error:e} at {tolerance:e} of {suspension:?} by {plan:?}");
        }
    }
}

/// Just before and just after the box is remapped, its rows are shifted by the largest possible number of points, to
/// the right and to the left. The lattices differ by 1e-9, so the motions agree to the tolerance, and are the same on
/// any number of ranks.
#[test]
fn turning_a_long_box_back_changes_the_motion_by_less_than_the_tolerance() {
    let (edges, half) = (Vector::new(90.0, 4.0, 5.0), 11.25);
    let before = Suspension::random(6, 1.4, PeriodicBox::sheared(edges, half - 1e-9).unwrap(), 11);
    let after = PeriodicBox::sheared(edges, half + 1e-9).unwrap();
    assert!(before.cell.strain() > 11.0 && after.strain() < -11.0);
    let positions = before.positions.iter().map(|p| after.wrap(*p).0).collect();
    let (loads, after) = (before.loads(5), Suspension { cell: after, positions, ..before.clone() });
    for tolerance in [1e-2, 1e-4, 1e-8] {
        let plan = before.plan(tolerance, Fixed::default());
        let motion = before.evaluate(&plan, &loads);
        let change = worst(&after.evaluate(&plan, &loads), &motion);
        assert!(change < tolerance, "{tolerance:e}: {change:e}");
        for table in [[2, 1], [2, 2]] {
            let shared = on_ranks(&before, &plan, table, &loads, |partition, particles, loads| {
                let mut mobility = Mobility::new(&plan, partition);
                mobility.arrange(&before.cell, particles);
                (mobility.apply(loads, Output::All), Vec::new())
            });
            // Sums are taken in a different order.
            let room = if plan.precision == Precision::Single { 1e-6 } else { 1e-12 };
            assert!(worst(&shared.0, &motion) < room, "{tolerance:e} on {table:?}");
        }
    }
}
