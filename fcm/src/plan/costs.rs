//! Costs of the parts of an evaluation.

/// One number for each part of an evaluation: seconds, or ratios of the seconds on a machine to those on which the
/// planner was calibrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Costs {
    /// Spreading of loads to the grid, and interpolation from the grid to motions.
    pub stencils: f64,
    /// Transforms and the Stokes solve between them.
    pub transforms: f64,
    /// Pairs within the cutoff.
    pub pairs: f64,
}

impl Default for Costs {
    /// The machine on which the planner was calibrated.
    fn default() -> Self {
        Self { stencils: 1.0, transforms: 1.0, pairs: 1.0 }
    }
}

impl Costs {
    /// Sum of the parts, each times its factor.
    pub(crate) fn total(&self, factors: &Self) -> f64 {
        self.stencils * factors.stencils + self.transforms * factors.transforms + self.pairs * factors.pairs
    }
}
