//! Motions of two spheres and the conjugate loads.

use std::ops::Add;

use domain::{Traceless, Vector};

/// Motion of two spheres relative to the ambient flow at their centres, `U - U_inf`, `Omega - Omega_inf`, `E - E_inf`.
///
/// A rigid sphere has `E = 0`, so its `strain_rate` here is minus that of the ambient flow.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PairMotion {
    /// Velocities.
    pub velocity: [Vector; 2],
    /// Angular velocities.
    pub angular_velocity: [Vector; 2],
    /// Rates of strain.
    pub strain_rate: [Traceless; 2],
}

/// Loads of two spheres on the fluid: forces, torques and symmetric traceless first moments.
///
/// The moment is conjugate to [`PairMotion::strain_rate`]: minus the stresslet that is positive along the ambient
/// strain.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PairLoads {
    /// Forces.
    pub force: [Vector; 2],
    /// Torques about the centres.
    pub torque: [Vector; 2],
    /// Symmetric traceless first moments about the centres.
    pub moment: [Traceless; 2],
}

impl Add for PairLoads {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            force: [0, 1].map(|i| self.force[i] + other.force[i]),
            torque: [0, 1].map(|i| self.torque[i] + other.torque[i]),
            moment: [0, 1].map(|i| self.moment[i] + other.moment[i]),
        }
    }
}

impl PairMotion {
    /// Rate of work of loads in this motion.
    pub fn power(&self, loads: &PairLoads) -> f64 {
        let sphere = |i: usize| {
            self.velocity[i].dot(loads.force[i])
                + self.angular_velocity[i].dot(loads.torque[i])
                + self.strain_rate[i].contract(loads.moment[i])
        };
        sphere(0) + sphere(1)
    }
}
