//! Costs of the parts of an evaluation.

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
