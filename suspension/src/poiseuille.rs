//! The flow between walls that a pressure gradient drives.

use domain::{Traceless, Vector};

/// The flow `u = curvature z (height - z) / 2` along x between walls at `z = 0` and at the height, with the curvature the pressure
/// gradient over the viscosity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Poiseuille {
    /// `-u''`, one over time and length.
    pub curvature: f64,
    /// Distance of the walls.
    pub height: f64,
}

impl Poiseuille {
    /// The rate of shear `du/dz`.
    pub fn shear_rate(&self, z: f64) -> f64 {
        0.5 * self.curvature * (self.height - 2.0 * z)
    }

    /// The velocity.
    pub fn velocity(&self, z: f64) -> Vector {
        Vector::X * (0.5 * self.curvature * z * (self.height - z))
    }

    /// The velocity of a free sphere of a radius in the flow without walls, `u + a^2/6 u''` (Faxen).
    pub fn velocity_of(&self, z: f64, radius: f64) -> Vector {
        self.velocity(z) - Vector::X * (self.curvature * radius * radius / 6.0)
    }

    /// Half of the vorticity.
    pub fn angular_velocity(&self, z: f64) -> Vector {
        Vector::Y * (0.5 * self.shear_rate(z))
    }

    /// The rate of strain at `z = 0`, and by how much its xz component grows with z.
    pub fn strain_rate(&self) -> (Traceless, f64) {
        (Traceless([0.0, 0.0, 0.5 * self.shear_rate(0.0), 0.0, 0.0]), -0.5 * self.curvature)
    }
}
