//! Prepared scenes: the data from which an evaluation starts.

use crate::error::gap::Gap;
use crate::flow::periodic_cell::PeriodicCell;
use crate::model::Model;
use crate::model::radii::Radii;
use crate::neighbourhood::smallest_gap;
use domain::{Comm, DomainView, Failure, Particles, Partition, PeriodicBox};
use fcm::{Plan, Problem};

/// Radii of a scene's particles, and the plan of the far field.
pub struct Planned {
    /// Radii of all particles.
    pub radii: Radii,
    /// Plan of the far field.
    pub plan: Plan,
}

/// Plans a scene in a box that may differ from its own, if there is memory for it. Collective.
pub type Replan = fn(&PeriodicBox, &Model, Radii, &Comm) -> Result<Planned, Failure>;

/// A prepared scene, for a run or its outline.
pub struct Setup {
    /// This rank's particles.
    pub particles: Particles,
    /// Radii of all particles.
    pub radii: Radii,
    /// Plan of the far field.
    pub plan: Plan,
    /// The problem that it solves.
    pub problem: Problem,
    /// Partition of space among ranks.
    pub partition: Partition,
    /// The box and the background flow.
    pub moving: PeriodicCell,
    /// Upper bound of the displacement by which overlapping spheres were moved apart, if any overlapped.
    pub farthest: Option<Gap>,
    /// New plan for a box that follows the spheres.
    pub replan: Replan,
}

/// Partition of space among ranks.
pub fn partition(plan: &Plan, comm: &Comm) -> Partition {
    Partition::new(comm, [plan.grid[1], plan.grid[2]])
}

impl Planned {
    /// Partition of space among ranks.
    pub fn partition(&self, comm: &Comm) -> Partition {
        partition(&self.plan, comm)
    }
}

impl Setup {
    /// A warning about overlapping spheres that were moved apart, if there were any.
    pub fn relaxed(&self) -> Option<String> {
        let farthest = self.farthest?;
        Some(format!("spheres overlap at the start; with [contacts] they are moved apart first, by {farthest} at most"))
    }

    /// Smallest gap between the surfaces of two particles. Collective.
    pub fn gap(&self) -> Gap {
        let length = smallest_gap(&self.particles, DomainView { cell: self.moving.cell(), partition: &self.partition });
        Gap { length, radius: self.radii.smallest() }
    }
}
