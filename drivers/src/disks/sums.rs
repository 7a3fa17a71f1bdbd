//! The sums that a time step with measurement computes.

use domain::Vector;
use std::ops::Add;

/// Sums over the pairs that touch.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ContactSums {
    /// Contacts that have just begun: of two small disks, a small and a large, two large.
    pub(super) encounters: [u64; 3],
    pub(super) contacts: u64,
    /// Energy of the springs.
    pub(super) spring: f64,
    /// Power that damping takes.
    pub(super) loss: f64,
    /// Force on the second disk times the velocity of its image's flow past its own.
    pub(super) jump_work: f64,
    /// xx, xy and yy of separation times force.
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

/// Sums over the disks; `w` is the velocity in excess of the liquid's.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MotionSums {
    /// `m w^2 / 2`.
    pub(super) kinetic: f64,
    /// xx, xy and yy of `m w w`.
    pub(super) flux: Vector,
    /// `|w|`.
    pub(super) excess: f64,
    /// Power that drag takes, `6 pi r viscosity w^2`.
    pub(super) drag: f64,
    /// `m u' w_x w_y + F_x u`, which the flow gives with the opposite sign.
    pub(super) flow_work: f64,
    /// Largest squared distance from the place that the flow would have carried a disk to.
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
