//! Grids of any even number of points keep the tolerance, against a sum without a grid.

use crate::common::{Suspension, on_ranks, worst};
use domain::{PeriodicBox, Vector};
use fcm::{Fixed, Loads, Method, Mobility, Output, Plan, Precision};

/// Points along each axis, with factors 11, 13, 23 and 53, and a tolerance for which they suffice.
const GRIDS: [(usize, f64); 4] = [(22, 1e-2), (26, 1e-3), (46, 1e-6), (106, 1e-10)];

fn suspension() -> Suspension {
    Suspension::random(8, 1.3, PeriodicBox::sheared(Vector::splat(7.5), 0.2).unwrap(), 4)
}

fn plan(suspension: &Suspension, points: usize, tolerance: f64, method: Method) -> Plan {
    let fixed = Fixed { method: Some(method), precision: Some(Precision::Double), ..Fixed::default() };
    let free = suspension.plan(tolerance, fixed);
    let plan = suspension.plan(tolerance, Fixed { grid: Some([points; 3]), ..fixed });
    assert_eq!(plan.grid, [points; 3]);
    if method == Method::Direct {
        assert!(free.grid.into_iter().all(|n| n <= points), "{points} are not enough: {:?}", free.grid);
    }
    plan
}

#[test]
fn any_even_grid_keeps_the_tolerance() {
    let suspension = suspension();
    let loads = suspension.loads(11);
    let exact = suspension.motion(&loads);
    for method in [Method::Direct, Method::Split] {
        for (points, tolerance) in GRIDS {
            let error = worst(&suspension.evaluate(&plan(&suspension, points, tolerance, method), &loads), &exact);
            assert!(error < tolerance, "{method:?} on {points}: {error:e}");
        }
    }
}

#[test]
fn single_precision_keeps_the_tolerance() {
    let suspension = suspension();
    let loads = suspension.loads(12);
    let exact = suspension.motion(&loads);
    for (points, tolerance) in [(22, 1e-2), (46, 1e-4)] {
        let fixed = Fixed { grid: Some([points; 3]), precision: Some(Precision::Single), ..Fixed::default() };
        let error = worst(&suspension.evaluate(&suspension.plan(tolerance, fixed), &loads), &exact);
        assert!(error < tolerance, "{points}: {error:e}");
    }
}

/// Sums are taken in a different order, so the last digits differ.
#[test]
fn ranks_agree_on_any_even_grid() {
    let suspension = suspension();
    let loads = suspension.loads(13);
    let plan = plan(&suspension, GRIDS[1].0, GRIDS[1].1, Method::Split);
    let alone = suspension.evaluate(&plan, &loads);
    for table in [[1, 2], [3, 1], [1, 7], [7, 1], [2, 2]] {
        let answer = |partition: &domain::Partition, particles: &domain::Particles, loads: &Loads| {
            let mut mobility = Mobility::new(&plan, partition);
            mobility.arrange(&suspension.cell, particles);
            (mobility.apply(loads, Output::All), Vec::new())
        };
        let error = worst(&on_ranks(&suspension, &plan, table, &loads, answer).0, &alone);
        assert!(error < 1e-12, "{table:?}: {error:e}");
    }
}
