//! Sums computed in a time step with measurement.

use super::state::LaneValues;
use domain::Vector;
use std::ops::Add;

/// Sums over the pairs in contact.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ContactSums {
    /// Numbers of contacts that have just begun: of two small disks, of a small and a large one, of two large ones.
    pub(super) encounters: Vector,
    /// Number of contacts.
    pub(super) contacts: f64,
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
            encounters: self.encounters + other.encounters,
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
    /// `m w^2 / 2`; xx, xy and yy components of `m w w`; `|w|`; the power dissipated by drag, `6 pi r viscosity w^2`;
    /// and `m u' w_x w_y + F_x u`, the negative of the power from the flow.
    pub(super) terms: [T; 7],
    /// Largest squared distance of a disk from the point to which the flow would have carried it.
    pub(super) drift_squared: T,
}

impl MotionSums<LaneValues> {
    pub(super) fn total(&self) -> MotionSums {
        let drift_squared = self.drift_squared.iter().copied().fold(0.0, f64::max);
        MotionSums { terms: self.terms.each_ref().map(|lanes| lanes.iter().sum()), drift_squared }
    }
}

impl Add for MotionSums {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let terms = std::array::from_fn(|k| self.terms[k] + other.terms[k]);
        Self { terms, drift_squared: self.drift_squared.max(other.drift_squared) }
    }
}
