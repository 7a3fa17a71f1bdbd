//! Methods of the far field, and the interface for those without a grid.

mod dense;

use crate::plan::costs::Costs;
use crate::plan::problem::{Multipoles, Problem};
use crate::plan::{Plan, PlanError};
use domain::Bytes;

/// Method of evaluation of the far field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Each envelope itself is spread, so the smallest one sets the grid.
    Direct,
    /// All particles share one wider Gaussian on the grid, and pairs within the cutoff make up the difference.
    Split,
    /// A matrix of exact sums over all pairs, for few particles.
    Dense,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 3] = [Self::Direct, Self::Split, Self::Dense];

    /// Name of the method in scenes and descriptions.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Split => "split",
            Self::Dense => "dense",
        }
    }
}

impl Method {
    /// Planning of the method, unless it has a grid: then [`crate::plan::planner`] compares candidates.
    pub(crate) fn gridless(self) -> Option<&'static dyn Gridless> {
        match self {
            Self::Direct | Self::Split => None,
            Self::Dense => Some(&dense::Dense),
        }
    }
}

/// Planning of a method without a grid.
pub(crate) trait Gridless {
    /// Refuses problems that the method can't solve, apart from boundaries: it is for periodic boxes.
    fn check(&self, problem: &Problem) -> Result<(), PlanError>;

    /// The plan of a problem.
    fn plan(&self, problem: &Problem) -> Plan;

    /// Seconds for one evaluation by one thread on the machine on which the planner was calibrated.
    fn seconds(&self, plan: &Plan, particles: usize) -> Costs;

    /// Bytes of the set-up on a rank that owns some of all particles, and of an evaluation without its result.
    fn bytes(&self, multipoles: Multipoles, particles: RankParticles) -> GridlessBytes;

    /// Description after the method's name.
    fn description(&self) -> &'static str;
}

/// Numbers of particles on which the memory of a rank depends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RankParticles {
    pub owned: f64,
    /// On all ranks.
    pub total: f64,
}

/// Memory of a method without a grid on a rank.
pub(crate) struct GridlessBytes {
    pub arranged: Bytes,
    pub evaluation: Bytes,
}

/// Parameters of the split method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Split {
    /// Width of the common Gaussian.
    pub width: f64,
    /// Distance beyond which pairs are left out.
    pub cutoff: f64,
}
