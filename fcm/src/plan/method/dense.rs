//! Plans of the dense method: a matrix of exact sums over all pairs of spheres.

use crate::grid::stencil::Support;
use crate::plan::costs::Costs;
use crate::plan::device::ComputeDevice;
use crate::plan::method::{Gridless, GridlessBytes, Method, RankParticles};
use crate::plan::problem::{Multipoles, Precision, Problem};
use crate::plan::{Plan, PlanError};
use domain::{Bytes, readable_bytes};

/// Bytes of the largest matrix.
const LARGEST: f64 = (1_u64 << 31) as f64;

/// Points of a grid by which ranks share the box.
const GRID: [usize; 3] = [16; 3];

/// Relative error of the entries: round-off of the sums.
const ERROR: f64 = 1e-12;

/// Seconds for an entry when the matrix is applied, and when the entries of a pair of spheres are found.
const APPLIED: f64 = 0.6e-9;
const FOUND: f64 = 1e-4;

/// Bytes of a chunk of wavevectors for a component of a sphere's motion: 64 of four numbers each.
const WAVES: f64 = 2048.0;

/// Evaluations at the same positions that share the cost of the entries: those of a usual solve.
const EVALUATIONS: f64 = 10.0;

/// The dense method.
pub(super) struct Dense;

/// Bytes of the mobility of spheres as a matrix.
fn matrix_bytes(multipoles: Multipoles, spheres: f64) -> f64 {
    8.0 * (spheres * multipoles.components() as f64).powi(2)
}

impl Gridless for Dense {
    fn check(&self, problem: &Problem) -> Result<(), PlanError> {
        let bytes = matrix_bytes(problem.multipoles, problem.particles() as f64);
        if bytes > LARGEST {
            let most = (LARGEST / 8.0).sqrt() as usize / problem.multipoles.components();
            return Err(PlanError::Fixed(format!(
                "hydrodynamics.method \"dense\" takes a matrix of {} for {} spheres; it is for {most} spheres at most \
                 ({}), leave it out",
                readable_bytes(bytes),
                problem.particles(),
                readable_bytes(LARGEST)
            )));
        }
        let found = [("grid", problem.fixed.grid.is_some()), ("support", problem.fixed.support.is_some())];
        match found.into_iter().find(|(_, is_fixed)| *is_fixed) {
            Some((key, _)) => Err(PlanError::Fixed(format!(
                "hydrodynamics.{key} is set, but hydrodynamics.method is \"dense\", which has no grid; leave one of \
                 them out"
            ))),
            None => Ok(()),
        }
    }

    fn plan(&self, problem: &Problem) -> Plan {
        let plan = Plan {
            edges: problem.edges,
            boundaries: problem.boundaries,
            period: problem.edges,
            fluid_margin: None,
            smallest_edge_ratio: problem.smallest_edge_ratio,
            is_tilted: problem.is_tilted(),
            radii: problem.radii.iter().map(|r| r.0).collect(),
            viscosity: problem.viscosity,
            multipoles: problem.multipoles,
            tolerance: problem.tolerance,
            iteration_tolerance: problem.iteration_tolerance(),
            wavenumber_split_tolerance: problem.wavenumber_split_tolerance(),
            image_cutoff: problem.image_cutoff(),
            method: Method::Dense,
            split: None,
            device: ComputeDevice::Cpu,
            precision: Precision::Double,
            grid: GRID,
            support: Support { lanes: 8, support: 0, reach: 0.0 },
            predicted_error: ERROR,
            predicted_seconds: 0.0,
        };
        let seconds = self.seconds(&plan, problem.particles()).total(&problem.costs);
        Plan { predicted_seconds: seconds / (problem.ranks * problem.threads).max(1) as f64, ..plan }
    }

    /// With a share of the time for the entries.
    fn seconds(&self, plan: &Plan, particles: usize) -> Costs {
        let (pairs, components) = ((particles as f64).powi(2), plan.multipoles.components() as f64);
        let entries = APPLIED * pairs * components * components;
        Costs { stencils: 0.0, transforms: 0.0, pairs: entries + FOUND * pairs / EVALUATIONS }
    }

    /// Rows of the matrix, and the columns of a chunk of wavevectors while they are found; rows of the factor, and the
    /// whole matrix while it is factorised. In an evaluation, loads of all particles.
    fn bytes(&self, multipoles: Multipoles, RankParticles { owned, total }: RankParticles) -> GridlessBytes {
        let whole = matrix_bytes(multipoles, total);
        let rows = if total > 0.0 { whole * owned / total } else { 0.0 };
        let columns = Bytes::temporary(WAVES * total * multipoles.components() as f64);
        let factor = Bytes::keep(rows).then(Bytes::temporary(whole));
        let arranged = Bytes::keep(rows).then(columns).then(factor);
        GridlessBytes { arranged, evaluation: Bytes::list::<[f64; 33]>(total).freed() }
    }

    fn description(&self) -> &'static str {
        "matrix of exact sums over all pairs in f64"
    }
}
