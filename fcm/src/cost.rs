//! What an evaluation costs.

use crate::gaussian::length;
use crate::plan::Plan;
use crate::problem::{Method, Multipoles, Precision};

/// A number for each part of an evaluation: its seconds, or what those of a machine are over those that the planner was
/// made on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Costs {
    /// Loads to the grid, and the grid to motions.
    pub stencils: f64,
    /// The transforms and the Stokes solve between them.
    pub transforms: f64,
    /// Near pairs.
    pub pairs: f64,
}

impl Default for Costs {
    /// The machine that the planner was made on.
    fn default() -> Self {
        Self { stencils: 1.0, transforms: 1.0, pairs: 1.0 }
    }
}

impl Costs {
    /// All parts together, each times its factor.
    pub(crate) fn total(&self, factors: &Self) -> f64 {
        self.stencils * factors.stencils + self.transforms * factors.transforms + self.pairs * factors.pairs
    }
}

/// Seconds for one evaluation in a box of the given strain by one thread, as measured on one core of a Zen 4 processor.
/// `fcm-solve bench` prints what follows from them beside what it measures.
pub(crate) fn seconds(plan: &Plan, particles: usize, strain: f64) -> Costs {
    let single = plan.precision == Precision::Single;
    let points: f64 = plan.grid.iter().map(|&n| n as f64).product();
    let particles = particles as f64;
    let terms = if plan.multipoles == Multipoles::Dipole { 1.0 } else { 0.6 };
    let stencil = match plan.method {
        Method::Direct => {
            let rows = length(&plan.support, plan.spacing(), strain, if single { 16 } else { 8 });
            rows * if single { 19e-9 } else { 18e-9 }
        }
        // Rows of eight, of sixteen in two vectors.
        Method::Split { .. } => {
            let rows = (plan.support.support * plan.support.support) as f64;
            rows * if single { 12.5e-9 } else { 20e-9 } * (plan.support.support as f64 / 8.0).ceil()
        }
    };
    let neighbours = match plan.method {
        Method::Direct => 0.0,
        Method::Split { cutoff, .. } => {
            particles / (plan.edges.x * plan.edges.y * plan.edges.z) * 4.19 * cutoff.powi(3)
        }
    };
    Costs {
        stencils: particles * (stencil * terms + 4e-7),
        transforms: points * points.log2() * if single { 0.45e-9 } else { 0.88e-9 },
        pairs: particles * neighbours * 5.2e-8 * terms,
    }
}
