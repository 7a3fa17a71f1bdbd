//! Sums computed in a time step with measurement.

use domain::Vector;
use std::ops::Add;

/// Sums over the pairs in contact.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ContactSums {
    /// Contacts that have just begun: of two small disks, of a small and a large one, of two large ones.
    pub(super) encounters: [u64; 3],
    pub(super) contacts: u64,
    /// Elastic energy of the springs.
    pub(super) spring: f64,
    /// Power dissipated by damping.
    pub(super) loss: f64,
    /// Force on the second disk times the velocity of the flow at its image relative to that at the disk itself.
    pub(super) jump_work: f64,
    /// xx, xy and yy components of separation times force.
    pub(super) virial: Vector,
}

impl Add for ContactSums {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            encounters: std::array::from_fn(|k| self.encounters[k] + other.encounters[k]),
            contacts: self.contacts + other.contacts,
            spring: self.spring + other.spring,
            loss: self.loss + other.loss,
            jump_work: self.jump_work + other.jump_work,
            virial: self.virial + other.virial,
        }
    }
}

/// Sums over the disks; `w` is the velocity relative to the liquid.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MotionSums {
    /// `m w^2 / 2`.
    pub(super) kinetic: f64,
    /// xx, xy and yy components of `m w w`.
    pub(super) flux: Vector,
    /// `|w|`.
    pub(super) excess: f64,
    /// Power dissipated by drag, `6 pi r viscosity w^2`.
    pub(super) drag: f64,
    /// `m u' w_x w_y + F_x u`, the negative of the power from the flow.
    pub(super) flow_work: f64,
    /// Largest squared distance of a disk from the point to which the flow would have carried it.
    pub(super) drift_squared: f64,
}

impl Add for MotionSums {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            kinetic: self.kinetic + other.kinetic,
            flux: self.flux + other.flux,
            excess: self.excess + other.excess,
            drag: self.drag + other.drag,
            flow_work: self.flow_work + other.flow_work,
            drift_squared: self.drift_squared.max(other.drift_squared),
        }
    }
}
