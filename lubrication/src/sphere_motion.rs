//! Motion and loads of a sphere.

use domain::{Traceless, Vector};
use std::ops::{Add, Mul};

/// Motion of a sphere relative to the ambient flow at its centre, `U - U_inf`, `Omega - Omega_inf`, `E - E_inf`.
///
/// A rigid sphere has `E = 0`, so its `strain_rate` here is minus that of the ambient flow.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SphereMotion {
    /// Velocity.
    pub velocity: Vector,
    /// Angular velocity.
    pub angular_velocity: Vector,
    /// Rate of strain.
    pub strain_rate: Traceless,
}

/// Loads of a sphere on the fluid; the moment is conjugate to [`SphereMotion::strain_rate`]: minus the stresslet that
/// is positive along the ambient strain.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SphereLoads {
    /// Force.
    pub force: Vector,
    /// Torque about the centre.
    pub torque: Vector,
    /// Symmetric traceless first moment about the centre.
    pub moment: Traceless,
}

impl Add for SphereLoads {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { force: self.force + other.force, torque: self.torque + other.torque, moment: self.moment + other.moment }
    }
}

impl Mul<f64> for SphereLoads {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { force: self.force * factor, torque: self.torque * factor, moment: self.moment * factor }
    }
}

impl SphereMotion {
    /// Rate of work of loads in this motion.
    pub fn power(&self, loads: &SphereLoads) -> f64 {
        self.velocity.dot(loads.force)
            + self.angular_velocity.dot(loads.torque)
            + self.strain_rate.contract(loads.moment)
    }
}
