//! The three stages of a run, and the contacts, drag, flow and integrator of each.

use super::flow::VelocityProfile;
use super::gear::Corrector;
use super::{DiskModel, Gear, SpringContact};
use std::f64::consts::PI;
use std::ops::Range;

/// A stage of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Almost plastic contacts remove the overlaps of a random start.
    RemoveOverlaps,
    /// Elastic contacts bring the disks close to equilibrium.
    Equilibrate,
    /// The run itself: flow, drag and the contacts of the parameters.
    Flow,
}

impl Stage {
    /// All stages, in order.
    pub(super) const ALL: [Self; 3] = [Self::RemoveOverlaps, Self::Equilibrate, Self::Flow];

    pub(super) fn next(self) -> Option<Self> {
        Self::ALL.get(self as usize + 1).copied()
    }
}

/// The contacts, drag, flow and integrator of a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Law {
    pub(super) contact: SpringContact,
    pub(super) viscosity: f64,
    pub(super) profile: VelocityProfile,
    pub(super) gear: Gear,
    /// Strain of the lattice before the first step.
    pub(super) start_strain: f64,
    pub(super) dt: f64,
    /// Number of steps of the stage; the last stage has no end.
    pub(super) steps: Option<u64>,
}

impl Law {
    pub(super) fn corrector(&self) -> Corrector {
        self.gear.corrector(self.dt)
    }

    /// Stokes drag on a disk per unit of velocity.
    pub(super) fn drag(&self, radius: f64) -> f64 {
        6.0 * PI * radius * self.viscosity
    }

    /// The factors `kick` and `drag` of a disk in `dt^2 a / 2 = force * kick - excess * drag`, where `excess` is the
    /// velocity relative to the liquid.
    pub(super) fn response(&self, radius: f64, mass: f64) -> (f64, f64) {
        let kick = 0.5 * self.dt * self.dt / mass;
        (kick, self.drag(radius) * kick)
    }

    pub(super) fn strain(&self, step: u64) -> f64 {
        self.start_strain + self.strain_in(step)
    }

    /// Number of lattice periods by which the strain is reduced from one step to another.
    pub(super) fn lattice_shifts(&self, model: &DiskModel, steps: Range<u64>) -> i32 {
        let [length, height] = model.parameters().edges;
        let shifts = |step| (self.strain(step) * height / length + 0.5).floor() as i32;
        shifts(steps.end) - shifts(steps.start)
    }

    pub(super) fn strain_in(&self, steps: u64) -> f64 {
        self.profile.lattice_rate * self.dt * steps as f64
    }
}
