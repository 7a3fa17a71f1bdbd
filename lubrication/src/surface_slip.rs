//! Slip at the surface of a sphere, and loads by its modes.

use domain::{Tensor, Traceless, Vector};

use crate::sphere_motion::SphereLoads;
use crate::two_sphere::slip::SlipFunction;

/// Slip velocity at the surface of a sphere with the outward normal `n`, `(n n - I).b + (n.Q.n) n - Q.n`. A squirmer
/// with the axis `p` has `b = B1 p` and `Q = B2 (p p - I/3)`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SurfaceSlip {
    /// `b`
    pub first: Vector,
    /// `Q`
    pub second: Traceless,
}

/// Loads of a sphere of a given radius, by those of radius and viscosity 1 with the same slip.
pub fn scaled(SphereLoads { force, torque, moment }: SphereLoads, factor: f64, radius: f64) -> SphereLoads {
    let of_torque = factor * radius;
    SphereLoads { force: force * factor, torque: torque * of_torque, moment: moment * of_torque }
}

/// Loads by the slip of a sphere, with the values of the functions for an axis.
#[inline(always)]
pub fn loads_by_modes(d: Vector, value: impl Fn(SlipFunction) -> f64, slip: &SurfaceSlip) -> SphereLoads {
    let along = slip.first.dot(d);
    let across = slip.first - d * along;
    let pulled = slip.second.tensor() * d;
    let axial = 1.5 * pulled.dot(d);
    let bent = pulled - d * pulled.dot(d);
    let force = d * (value(SlipFunction::XF1) * along + value(SlipFunction::XF2) * axial)
        + across * value(SlipFunction::YF1)
        + bent * value(SlipFunction::YF2);
    let torque = d.cross(across * value(SlipFunction::YT1) + bent * value(SlipFunction::YT2));
    let unit_axial = Traceless::part_of(&outer(d, d));
    let sheared = |v: Vector| Traceless::part_of(&(outer(d, v) + outer(v, d)));
    let planar = slip.second - unit_axial * axial - sheared(bent);
    let moment = unit_axial * (1.5 * (value(SlipFunction::XS1) * along + value(SlipFunction::XS2) * axial))
        + sheared(across * value(SlipFunction::YS1) + bent * value(SlipFunction::YS2))
        + planar * value(SlipFunction::ZS2);
    SphereLoads { force, torque, moment }
}

/// `a_i b_j`
fn outer(a: Vector, b: Vector) -> Tensor {
    Tensor::from_cols(a * b.x, a * b.y, a * b.z)
}
