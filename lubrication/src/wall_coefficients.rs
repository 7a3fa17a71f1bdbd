//! Lubrication resistance of a sphere at a wall as coefficients of tensors of the normal.

use crate::pair_factor::LEVER;
use crate::sphere_motion::SphereLoads;
use crate::wall_table::WallFactors;
use domain::{Tensor, Traceless, Vector};

/// Resistance of a sphere at a wall with the unit vector `z` from its centre to the wall. Loads on the fluid by its
/// motion `U`, `Omega`, `E` relative to the ambient flow, with `t = E z - (z.E z) z`, are as between spheres (see
/// [`Coefficients`](crate::Coefficients), also for the notation of Jeffrey & Onishi),
///
/// ```text
/// F = xa (z.U) z + ya (U - (z.U) z) + yb Omega x z + xg_strain (z.E z) z + yg_strain t
/// L = xc (z.Omega) z + yc (Omega - (z.Omega) z) + yb z x U + yh_strain z x t
/// M = xg (z.U) (3 zz - 1) + z s + s z + zm E + xm_minus_zm_half (z.E z) (3 zz - 1) + ym_minus_zm (z t + t z)
/// s = yg (U - (z.U) z) + yh Omega x z
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WallCoefficients {
    /// `X^A`: force by velocity along the normal.
    pub xa: f64,
    /// `Y^A`: force by velocity along the wall.
    pub ya: f64,
    /// `X^C`: torque by angular velocity along the normal.
    pub xc: f64,
    /// `Y^C`: torque by angular velocity along the wall.
    pub yc: f64,
    /// `Y^B`: force by angular velocity, and torque by velocity.
    pub yb: f64,
    /// `X^G`: first moment by velocity along the normal.
    pub xg: f64,
    /// `Y^G`: first moment by velocity along the wall.
    pub yg: f64,
    /// `Y^H`: first moment by angular velocity.
    pub yh: f64,
    /// `X^G`: force along the normal by strain.
    pub xg_strain: f64,
    /// `Y^G`: force along the wall by strain.
    pub yg_strain: f64,
    /// `Y^H`: torque by strain.
    pub yh_strain: f64,
    /// `(X^M - Z^M)/2`: first moment by strain along the normal, in addition to `zm`.
    pub xm_minus_zm_half: f64,
    /// `Y^M - Z^M`: first moment by shear between the normal and the wall, in addition to `zm`.
    pub ym_minus_zm: f64,
    /// `Z^M`: first moment by any strain.
    pub zm: f64,
}

impl WallCoefficients {
    /// From factors that include `sqrt(viscosity * radius)`; the other powers of the radius follow.
    pub(crate) fn of(factors: &WallFactors, radius: f64) -> Self {
        let square = radius * radius;
        let [[approach], [lifted], [stretched]] =
            [factors.axial.factor, factors.axial.coupling, factors.axial.strain].map(|[value]| value);
        let xa = approach * approach;
        // Refers to the pole, whose velocity is that of the centre plus the lever times the rate of strain.
        let (gap, lifted) = (lifted, LEVER * xa - lifted);
        let axial = stretched - 2.0 * LEVER * gap + LEVER * LEVER * xa;
        let factor = &factors.transverse.factor;
        let transverse = |i: usize, j: usize| factor[i][0] * factor[j][0] + factor[i][1] * factor[j][1];
        let [[moved], [turned]] = factors.transverse.coupling;
        let zm = square * factors.planar;
        let (half, two) = (0.5_f64.sqrt(), 2.0_f64.sqrt());
        Self {
            xa,
            ya: transverse(0, 0),
            xc: square * factors.spin * factors.spin,
            yc: square * transverse(1, 1),
            yb: radius * transverse(0, 1),
            xg: radius * 1.5_f64.sqrt() / 3.0 * lifted,
            yg: radius * half * moved,
            yh: square * half * turned,
            xg_strain: radius * 1.5_f64.sqrt() * lifted,
            yg_strain: radius * two * moved,
            yh_strain: square * two * turned,
            xm_minus_zm_half: 0.5 * (square * axial - zm),
            ym_minus_zm: square * factors.transverse.strain[0][0] - zm,
            zm,
        }
    }

    /// Loads by a velocity and an angular velocity, with the unit vector `z` to the wall.
    pub fn by_motion(&self, z: Vector, [velocity, angular_velocity]: [Vector; 2]) -> SphereLoads {
        let (along, spin, rolled) = (z.dot(velocity), z.dot(angular_velocity), angular_velocity.cross(z));
        let across = velocity - along * z;
        let moment = axial(z) * (self.xg * along) + symmetric(z, self.yg * across + self.yh * rolled);
        SphereLoads {
            force: self.xa * along * z + self.ya * across + self.yb * rolled,
            torque: self.xc * spin * z + self.yc * (angular_velocity - spin * z) + self.yb * z.cross(velocity),
            moment: Traceless::part_of(&moment),
        }
    }

    /// Loads by a rate of strain.
    pub fn by_strain(&self, z: Vector, strain_rate: Traceless) -> SphereLoads {
        let strain = strain_rate.tensor();
        let stretch = z.dot(strain * z);
        let shear = strain * z - stretch * z;
        let moment =
            strain * self.zm + axial(z) * (self.xm_minus_zm_half * stretch) + symmetric(z, self.ym_minus_zm * shear);
        SphereLoads {
            force: self.xg_strain * stretch * z + self.yg_strain * shear,
            torque: self.yh_strain * z.cross(shear),
            moment: Traceless::part_of(&moment),
        }
    }
}

/// `3 zz - 1`
pub(crate) fn axial(z: Vector) -> Tensor {
    Tensor::from_cols(z * z.x, z * z.y, z * z.z) * 3.0 - Tensor::IDENTITY
}

/// `a b + b a`
fn symmetric(a: Vector, b: Vector) -> Tensor {
    Tensor::from_cols(a * b.x + b * a.x, a * b.y + b * a.y, a * b.z + b * a.z)
}
