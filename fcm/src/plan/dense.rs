//! Plans of the dense method: a matrix of exact sums over all pairs of spheres.

use crate::grid::stencil::Support;
use crate::plan::costs::Costs;
use crate::plan::problem::{Method, Precision, Problem};
use crate::plan::{Plan, PlanError};
use domain::readable_bytes;

/// Bytes of the largest matrix.
const LARGEST: f64 = (1_u64 << 31) as f64;

/// Points of a grid by which ranks share the box.
const GRID: [usize; 3] = [16; 3];

/// Relative error of the entries: round-off of the sums.
const ERROR: f64 = 1e-12;

/// Seconds for an entry when the matrix is applied, and when the entries of a pair of spheres are found.
const APPLIED: f64 = 0.6e-9;
const FOUND: f64 = 1e-4;

/// Evaluations at the same positions that share the cost of the entries: those of a usual solve.
const EVALUATIONS: f64 = 10.0;

impl Problem {
    /// Refuses a dense matrix that would be too large, and choices for grids beside it.
    pub(crate) fn check_dense(&self) -> Result<(), PlanError> {
        let bytes = self.multipoles.matrix_bytes(self.particles() as f64);
        if bytes > LARGEST {
            let most = (LARGEST / 8.0).sqrt() as usize / self.multipoles.components();
            return Err(PlanError::Fixed(format!(
                "hydrodynamics.method \"dense\" takes a matrix of {} for {} spheres; it is for {most} spheres at most \
                 ({}), leave it out",
                readable_bytes(bytes),
                self.particles(),
                readable_bytes(LARGEST)
            )));
        }
        let found = [("grid", self.fixed.grid.is_some()), ("support", self.fixed.support.is_some())];
        match found.into_iter().find(|(_, is_fixed)| *is_fixed) {
            Some((key, _)) => Err(PlanError::Fixed(format!(
                "hydrodynamics.{key} is set, but hydrodynamics.method is \"dense\", which has no grid; leave one of \
                 them out"
            ))),
            None => Ok(()),
        }
    }

    /// The plan of a dense matrix.
    pub(crate) fn dense(&self) -> Plan {
        let plan = Plan {
            edges: self.edges,
            boundaries: self.boundaries,
            period: self.edges,
            fluid_margin: None,
            smallest_edge_ratio: self.smallest_edge_ratio,
            is_tilted: self.is_tilted(),
            radii: self.radii.iter().map(|r| r.0).collect(),
            viscosity: self.viscosity,
            multipoles: self.multipoles,
            tolerance: self.tolerance,
            iteration_tolerance: self.iteration_tolerance(),
            wavenumber_split_tolerance: self.wavenumber_split_tolerance(),
            image_cutoff: self.image_cutoff(),
            method: Method::Dense,
            split: None,
            precision: Precision::Double,
            grid: GRID,
            support: Support { lanes: 8, support: 0, reach: 0.0 },
            predicted_error: ERROR,
            predicted_seconds: 0.0,
        };
        let seconds = seconds_of(&plan, self.particles()).total(&self.costs);
        Plan { predicted_seconds: seconds / (self.ranks * self.threads).max(1) as f64, ..plan }
    }
}

/// Seconds for one evaluation by one thread, with a share of the time for the entries.
pub(crate) fn seconds_of(plan: &Plan, particles: usize) -> Costs {
    let (pairs, components) = ((particles as f64).powi(2), plan.multipoles.components() as f64);
    let entries = APPLIED * pairs * components * components;
    Costs { stencils: 0.0, transforms: 0.0, pairs: entries + FOUND * pairs / EVALUATIONS }
}
