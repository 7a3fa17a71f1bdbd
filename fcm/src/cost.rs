//! What an evaluation costs: seconds of parts as measured on one core of a Zen 4 processor. `fcm-solve bench` prints
//! `predicted_seconds` beside what it measures. They are the same everywhere, so that a scene has one plan.

use crate::plan::{Method, Multipoles, Plan, Precision};

/// Seconds for one evaluation with as many ranks and threads in all.
pub(crate) fn seconds(plan: &Plan, particles: usize, ranks: usize, threads: usize) -> f64 {
    let single = plan.precision == Precision::Single;
    let points: f64 = plan.grid.iter().map(|&n| n as f64).product();
    let chunks =
        (plan.support.lanes as f64 / if single && plan.support.lanes.is_multiple_of(16) { 16.0 } else { 8.0 }).ceil();
    let rows = (plan.support.support * plan.support.support) as f64 * chunks;
    let terms = if plan.multipoles == Multipoles::Dipole { 1.0 } else { 0.6 };
    let grid = particles as f64 * (rows * if single { 18e-9 } else { 15e-9 } * terms + 6e-7);
    let transform = points * points.log2() * if single { 0.48e-9 } else { 0.95e-9 };
    let near = match plan.method {
        Method::Direct => 0.0,
        Method::Split { cutoff, .. } => {
            let volume = plan.edges.x * plan.edges.y * plan.edges.z;
            let neighbours = particles as f64 / volume * 4.19 * cutoff.powi(3);
            particles as f64 * neighbours * 8e-8 * terms
        }
    };
    (grid + transform + near) / (ranks * threads).max(1) as f64
}
