//! Sums computed in a time step with measurement.

use super::state::LaneValues;
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
    pub(super) image_work: f64,
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
            image_work: self.image_work + other.image_work,
            virial: self.virial + other.virial,
        }
    }
}

/// Sums over the disks, one for each SIMD lane or over all lanes; `w` is the velocity relative to the liquid.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MotionSums<T = f64> {
    /// `m w^2 / 2`.
    pub(super) kinetic: T,
    /// xx, xy and yy components of `m w w`.
    pub(super) flux: [T; 3],
    /// `|w|`.
    pub(super) excess: T,
    /// Power dissipated by drag, `6 pi r viscosity w^2`.
    pub(super) drag: T,
    /// `m u' w_x w_y + F_x u`, the negative of the power from the flow.
    pub(super) flow_work: T,
    /// Largest squared distance of a disk from the point to which the flow would have carried it.
    pub(super) drift_squared: T,
}

impl MotionSums<LaneValues> {
    pub(super) fn total(&self) -> MotionSums {
        let sum = |lanes: &LaneValues| lanes.iter().sum::<f64>();
        MotionSums {
            kinetic: sum(&self.kinetic),
            flux: self.flux.each_ref().map(sum),
            excess: sum(&self.excess),
            drag: sum(&self.drag),
            flow_work: sum(&self.flow_work),
            drift_squared: self.drift_squared.iter().copied().fold(0.0, f64::max),
        }
    }
}

impl Add for MotionSums {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            kinetic: self.kinetic + other.kinetic,
            flux: std::array::from_fn(|k| self.flux[k] + other.flux[k]),
            excess: self.excess + other.excess,
            drag: self.drag + other.drag,
            flow_work: self.flow_work + other.flow_work,
            drift_squared: self.drift_squared.max(other.drift_squared),
        }
    }
}
