//! Lubrication resistance of a sphere at a wall as coefficients of tensors of the normal.

use crate::pair_factor::LEVER;
use crate::sphere_motion::SphereLoads;
use crate::wall_table::WallRoots;
use domain::{Tensor, Traceless, Vector};

/// Resistance of a sphere at a wall with the unit vector `z` from its centre to the wall. Loads on the fluid by its
/// motion `U`, `Omega`, `E` relative to the ambient flow, with `t = E z - (z.E z) z`, are as between spheres (see
/// [`Coefficients`](crate::Coefficients), also for the notation of Jeffrey & Onishi),
///
/// ```text
/// F = along (z.U) z + across (U - (z.U) z) + coupling Omega x z + push (z.E z) z + slide t
/// L = spin (z.Omega) z + roll (Omega - (z.Omega) z) + coupling z x U + twist z x t
/// M = pull (z.U) (3 zz - 1) + z s + s z + bulk E + stretch (z.E z) (3 zz - 1) + bend (z t + t z)
/// s = drag (U - (z.U) z) + turn Omega x z
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WallCoefficients {
    /// `X^A`: force by velocity along the normal.
    pub along: f64,
    /// `Y^A`: force by velocity along the wall.
    pub across: f64,
    /// `X^C`: torque by angular velocity along the normal.
    pub spin: f64,
    /// `Y^C`: torque by angular velocity along the wall.
    pub roll: f64,
    /// `Y^B`: force by angular velocity, and torque by velocity.
    pub coupling: f64,
    /// `X^G`: first moment by velocity along the normal.
    pub pull: f64,
    /// `Y^G`: first moment by velocity along the wall.
    pub drag: f64,
    /// `Y^H`: first moment by angular velocity.
    pub turn: f64,
    /// `X^G`: force along the normal by strain.
    pub push: f64,
    /// `Y^G`: force along the wall by strain.
    pub slide: f64,
    /// `Y^H`: torque by strain.
    pub twist: f64,
    /// `(X^M - Z^M)/2`: first moment by strain along the normal, in addition to `bulk`.
    pub stretch: f64,
    /// `Y^M - Z^M`: first moment by shear between the normal and the wall, in addition to `bulk`.
    pub bend: f64,
    /// `Z^M`: first moment by any strain.
    pub bulk: f64,
}

impl WallCoefficients {
    /// From factors that include `sqrt(viscosity * radius)`; the other powers of the radius follow.
    pub(crate) fn of(roots: &WallRoots, radius: f64) -> Self {
        let square = radius * radius;
        let [[approach], [lifted], [stretched]] =
            [roots.axial.root, roots.axial.coupling, roots.axial.strain].map(|[value]| value);
        let along = approach * approach;
        // Refers to the pole, whose velocity is that of the centre plus the lever times the rate of strain.
        let (gap, lifted) = (lifted, LEVER * along - lifted);
        let axial = stretched - 2.0 * LEVER * gap + LEVER * LEVER * along;
        let root = &roots.transverse.root;
        let across = |i: usize, j: usize| root[i][0] * root[j][0] + root[i][1] * root[j][1];
        let [[moved], [turned]] = roots.transverse.coupling;
        let bulk = square * roots.planar;
        let (half, two) = (0.5_f64.sqrt(), 2.0_f64.sqrt());
        Self {
            along,
            across: across(0, 0),
            spin: square * roots.spin * roots.spin,
            roll: square * across(1, 1),
            coupling: radius * across(0, 1),
            pull: radius * 1.5_f64.sqrt() / 3.0 * lifted,
            drag: radius * half * moved,
            turn: square * half * turned,
            push: radius * 1.5_f64.sqrt() * lifted,
            slide: radius * two * moved,
            twist: square * two * turned,
            stretch: 0.5 * (square * axial - bulk),
            bend: square * roots.transverse.strain[0][0] - bulk,
            bulk,
        }
    }

    /// Loads by a velocity and an angular velocity, with the unit vector `z` to the wall.
    pub fn by_motion(&self, z: Vector, [velocity, angular_velocity]: [Vector; 2]) -> SphereLoads {
        let (along, spin, rolled) = (z.dot(velocity), z.dot(angular_velocity), angular_velocity.cross(z));
        let across = velocity - along * z;
        let moment = axial(z) * (self.pull * along) + symmetric(z, self.drag * across + self.turn * rolled);
        SphereLoads {
            force: self.along * along * z + self.across * across + self.coupling * rolled,
            torque: self.spin * spin * z
                + self.roll * (angular_velocity - spin * z)
                + self.coupling * z.cross(velocity),
            moment: Traceless::part_of(&moment),
        }
    }

    /// Loads by a rate of strain.
    pub fn by_strain(&self, z: Vector, strain_rate: Traceless) -> SphereLoads {
        let strain = strain_rate.tensor();
        let stretch = z.dot(strain * z);
        let shear = strain * z - stretch * z;
        let moment = strain * self.bulk + axial(z) * (self.stretch * stretch) + symmetric(z, self.bend * shear);
        SphereLoads {
            force: self.push * stretch * z + self.slide * shear,
            torque: self.twist * z.cross(shear),
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
