//! What an evaluation costs: seconds of parts as measured on one core of a Zen 4 processor. `fcm-solve bench` prints
//! `predicted_seconds` beside what it measures. They are the same everywhere, so that a scene has one plan.

use crate::gaussian::length;
use crate::plan::Plan;
use crate::problem::{Method, Multipoles, Precision};

/// Seconds for one evaluation in a box of the given strain, with as many threads on all ranks.
pub(crate) fn seconds(plan: &Plan, particles: usize, strain: f64, workers: usize) -> f64 {
    let single = plan.precision == Precision::Single;
    let points: f64 = plan.grid.iter().map(|&n| n as f64).product();
    let lanes = if single { 16 } else { 8 };
    let terms = if plan.multipoles == Multipoles::Dipole { 1.0 } else { 0.6 };
    let stencil = match plan.method {
        Method::Direct => {
            let rows = length(&plan.support, plan.spacing(), strain, lanes);
            rows * if single { 19e-9 } else { 18e-9 }
        }
        // Rows of eight, of sixteen in two vectors.
        Method::Split { .. } => {
            let rows = (plan.support.support * plan.support.support) as f64;
            rows * if single { 12.5e-9 } else { 20e-9 } * (plan.support.support as f64 / 8.0).ceil()
        }
    };
    let grid = particles as f64 * (stencil * terms + 4e-7);
    let transform = points * points.log2() * if single { 0.45e-9 } else { 0.88e-9 };
    let near = match plan.method {
        Method::Direct => 0.0,
        Method::Split { cutoff, .. } => {
            let volume = plan.edges.x * plan.edges.y * plan.edges.z;
            let neighbours = particles as f64 / volume * 4.19 * cutoff.powi(3);
            particles as f64 * neighbours * 5.2e-8 * terms
        }
    };
    (grid + transform + near) / workers.max(1) as f64
}
