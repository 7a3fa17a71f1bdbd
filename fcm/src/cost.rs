//! What an evaluation costs: seconds of parts as measured on one core of a Zen 4 processor. `fcm-solve bench` prints
//! `predicted_seconds` beside what it measures. They are the same everywhere, so that a scene has one plan.

use crate::passes;
use crate::plan::Plan;
use crate::problem::{Method, Multipoles, Precision};

/// Seconds for one evaluation in a box of the given strain, with as many threads on all ranks.
pub(crate) fn seconds(plan: &Plan, particles: usize, strain: f64, workers: usize) -> f64 {
    let single = plan.precision == Precision::Single;
    let points: f64 = plan.grid.iter().map(|&n| n as f64).product();
    let lanes = if single { 16 } else { 8 };
    let rows = passes::length(&plan.support, plan.spacing(), strain, lanes);
    let terms = if plan.multipoles == Multipoles::Dipole { 1.0 } else { 0.6 };
    let grid = particles as f64 * (rows * if single { 19e-9 } else { 18e-9 } * terms + 4.5e-7);
    let transform = points * points.log2() * if single { 0.48e-9 } else { 0.95e-9 };
    let near = match plan.method {
        Method::Direct => 0.0,
        Method::Split { cutoff, .. } => {
            let volume = plan.edges.x * plan.edges.y * plan.edges.z;
            let neighbours = particles as f64 / volume * 4.19 * cutoff.powi(3);
            particles as f64 * neighbours * 6e-8 * terms
        }
    };
    (grid + transform + near) / workers.max(1) as f64
}
