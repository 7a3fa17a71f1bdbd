//! The background flow at contacts.

use super::touching::Touching;
use crate::flow::periodic_cell::PeriodicCell;
use domain::{Traceless, Vector};
use hydrodynamics::StrainRate;
use lubrication::PairKind;

/// The flow relative to which velocities are given.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactFlow {
    /// Strain rate, and angular velocity at `z = 0`.
    strain_rate: StrainRate,
    turning: Vector,
    /// Expected change of the strain rate.
    pub besides: Traceless,
}

impl ContactFlow {
    /// The flow of a box, and the expected change of its strain rate.
    pub fn of(moving: &PeriodicCell) -> Self {
        Self {
            strain_rate: moving.strain_rate(),
            turning: moving.angular_velocity_at(Vector::ZERO),
            besides: moving.predicted_strain_rate_change(),
        }
    }

    /// Velocity at which the strain of the flow at the contact separates the centres. It lets spheres slip that rotate
    /// with the local flow.
    pub fn strained(&self, contact: &Touching) -> Vector {
        strained(contact, self.strain_rate.at(contact.place.z))
    }

    /// Rolling velocity, over a wall at rest, of a sphere that rotates with the fluid.
    pub fn rolled(&self, contact: &Touching) -> Vector {
        let PairKind::Wall(_) = contact.between else { return Vector::ZERO };
        let turning = self.turning + self.strain_rate.turning((contact.place - contact.separation).z);
        -contact.between.harmonic_radius() * turning.cross(contact.axis)
    }
}

/// Velocity at which a strain rate separates the centres.
pub(super) fn strained(contact: &Touching, strain_rate: Traceless) -> Vector {
    strain_rate.tensor() * contact.separation
}
