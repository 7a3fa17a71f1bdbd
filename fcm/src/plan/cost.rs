//! Cost model of an evaluation.

use crate::grid::gaussian::length;
use crate::plan::Plan;
use crate::plan::costs::Costs;
use crate::plan::device::ComputeDevice;
use crate::plan::device::card_costs::{CardClass, CardWork};
use crate::plan::method::{Method, Split};
use crate::plan::problem::{Multipoles, Precision, Problem};

/// Bytes of a grid that stay in the caches: a few megabytes.
const CACHE: f64 = 3.3e6;

/// Seconds per byte that a rank writes to another's memory on the same machine.
const SENT: f64 = 0.5e-9;

/// Seconds per image in a wall, including its share of the search for images in a solve.
const IMAGE: f64 = 4e-7;

impl Plan {
    /// Seconds expected of the parts of an evaluation of this many particles by one thread, on the machine on which
    /// the model was calibrated.
    #[must_use]
    pub fn parts(&self, particles: usize) -> Costs {
        seconds(self, particles, 0.0, 1)
    }
}

/// Seconds of an evaluation of a problem, on all its threads or on its card.
pub(crate) fn predicted(plan: &Plan, problem: &Problem) -> f64 {
    let parts = seconds(plan, problem.particles(), problem.largest_strain, problem.ranks);
    let seconds = parts.total(&problem.costs);
    match plan.device {
        ComputeDevice::Cpu => seconds / (problem.ranks * problem.threads).max(1) as f64,
        ComputeDevice::Gpu => seconds,
    }
}

fn grid_points(plan: &Plan) -> f64 {
    plan.grid.iter().map(|&n| n as f64).product()
}

/// Mean number of particles within the cutoff of one.
fn neighbours(plan: &Plan, particles: f64) -> f64 {
    plan.split.map_or(0.0, |Split { cutoff, .. }| {
        particles / (plan.edges.x * plan.edges.y * plan.edges.z) * 4.19 * cutoff.powi(3)
    })
}

fn work_on_card(plan: &Plan, particles: usize) -> CardWork {
    let particles = particles as f64;
    CardWork {
        stencil_points: particles * (plan.support.support as f64).powi(3),
        grid_points: grid_points(plan),
        pairs: particles * neighbours(plan, particles),
        is_single: plan.precision == Precision::Single,
    }
}

/// Seconds for one evaluation in a box of the given strain by one thread on each of `ranks` ranks together, as
/// measured on a Zen 4 processor; with a plan for a card, those on the card. `fcm-solve bench` prints predictions
/// beside measured times.
pub(crate) fn seconds(plan: &Plan, particles: usize, strain: f64, ranks: usize) -> Costs {
    if let Some(gridless) = plan.method.gridless() {
        return gridless.seconds(plan, particles);
    }
    if plan.device == ComputeDevice::Gpu {
        let on_card = CardClass::present().seconds(&work_on_card(plan, particles));
        // Images in walls are made on the host.
        return Costs { pairs: on_card.pairs + particles as f64 * plan.images(particles as f64) * IMAGE, ..on_card };
    }
    let single = plan.precision == Precision::Single;
    let points = grid_points(plan);
    // The potential of moments has one component.
    let of_grid = if plan.multipoles == Multipoles::Moments { 1.0 / 3.0 } else { 1.0 };
    let bytes = of_grid * points * if single { 12.0 } else { 24.0 };
    // Part of the grid that is fetched from main memory in each pass.
    let spilt = (bytes / CACHE - 1.0).clamp(0.0, 1.0);
    let particles = particles as f64;
    let [terms, pair_terms] = match plan.multipoles {
        Multipoles::Dipole => [1.0; 2],
        Multipoles::Monopole => [0.6; 2],
        Multipoles::Moments => [0.4, 0.6],
    };
    let stencil = if plan.method == Method::Direct {
        let rows = length(&plan.support, plan.spacing(), strain, if single { 16 } else { 8 });
        rows * if single { 18e-9 } else { 17e-9 }
    } else {
        // Rows of eight points, or of sixteen in two vectors.
        let rows = (plan.support.support * plan.support.support) as f64;
        rows * 12.5e-9 * (plan.support.support as f64 / 8.0).ceil()
    };
    let neighbours = neighbours(plan, particles);
    let transform = if single { 0.31e-9 + 0.15e-9 * spilt } else { 0.6e-9 + 0.28e-9 * spilt };
    let sent = 2.0 * bytes * (1.0 - 1.0 / ranks.max(1) as f64);
    Costs {
        stencils: particles * (stencil * terms + 4e-7) + 0.65e-9 * bytes * spilt,
        transforms: of_grid * points * points.log2() * transform + SENT * sent,
        pairs: particles * (neighbours * 5.2e-8 * pair_terms + plan.images(particles) * IMAGE),
    }
}
