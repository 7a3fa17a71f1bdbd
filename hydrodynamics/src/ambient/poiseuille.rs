//! Pressure-driven flow between walls.

use crate::ambient::StrainRate;
use domain::{Particles, Traceless, Vector};
use fcm::{Motion, Multipoles};

/// The flow `u = curvature z (height - z) / 2` along x between walls at `z = 0` and `z = height`, with the curvature
/// the pressure gradient over the viscosity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Poiseuille {
    /// Curvature `-u''`, one over time and length.
    pub curvature: f64,
    /// Distance of the walls.
    pub height: f64,
}

impl Poiseuille {
    /// Shear rate `du/dz`.
    pub fn shear_rate(&self, z: f64) -> f64 {
        0.5 * self.curvature * (self.height - 2.0 * z)
    }

    /// Velocity of the fluid.
    pub fn velocity(&self, z: f64) -> Vector {
        Vector::X * (0.5 * self.curvature * z * (self.height - z))
    }

    /// Velocity of a free sphere in this flow, without the effect of walls: `u + a^2/6 u''` (Faxen).
    pub fn velocity_of(&self, z: f64, radius: f64) -> Vector {
        self.velocity(z) - Vector::X * (self.curvature * radius * radius / 6.0)
    }

    /// Angular velocity of the fluid, half the vorticity.
    pub fn angular_velocity(&self, z: f64) -> Vector {
        Vector::Y * (0.5 * self.shear_rate(z))
    }

    /// Motions of free spheres in this flow, without the effect of walls, with the strain rates at their centres; with
    /// forces alone, the velocities only.
    pub fn motion(&self, spheres: &Particles, multipoles: Multipoles) -> Motion {
        let places = || spheres.positions.iter().map(|place| place.z);
        let velocities = places().zip(&spheres.radii).map(|(z, &radius)| self.velocity_of(z, radius)).collect();
        if multipoles == Multipoles::Monopole {
            return Motion { velocities, ..Motion::default() };
        }
        let strain_rate = |z: f64| Traceless([0.0, 0.0, 0.5 * self.shear_rate(z), 0.0, 0.0]);
        Motion {
            velocities,
            angular_velocities: places().map(|z| self.angular_velocity(z)).collect(),
            strain_rates: places().map(strain_rate).collect(),
        }
    }

    /// Strain rate.
    pub fn strain_rate(&self) -> StrainRate {
        let at_zero = Traceless([0.0, 0.0, 0.5 * self.shear_rate(0.0), 0.0, 0.0]);
        StrainRate { at_zero, slope: [-0.5 * self.curvature, 0.0] }
    }
}
