//! Boundary conditions at a bumpy, frictionless wall (Jenkins and Richman 1986).

use super::{GrainProperties, jet::Jet};
use std::f64::consts::PI;

/// Shape of the wall's bumps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WallShape {
    /// Half-disks (half-cylinders across the flow).
    #[default]
    Disk,
    /// Hemispheres.
    Sphere,
}

/// The paper's factors R5 to R8 on the terms of the wall laws: 0 for smooth, 1 for rough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roughness {
    /// Factor on the slip law.
    pub r5: f64,
    /// Factor on the energy lost in inelastic collisions with the wall.
    pub r6: f64,
    /// Factor on the energy supplied by slip.
    pub r7: f64,
    /// Factor on the energy supplied by slip and gradient together.
    pub r8: f64,
}

/// Properties of a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wall {
    /// Shape of the bumps.
    pub shape: WallShape,
    /// Depth to which a grain reaches between two bumps, as an angle: `sin theta = (Dw + gap) / (Dw + D)`,
    /// in radians, at most pi/2.
    pub theta: f64,
    /// Whether the traction includes the term in the velocity gradient.
    pub gradient: bool,
    /// Diameter `Dw` of the bumps.
    pub diameter: f64,
    /// Coefficient of restitution between a grain and the wall.
    pub restitution: f64,
    /// Factors on the terms of the wall laws.
    pub roughness: Roughness,
}

/// The integrals over a bump, in units of the grains' density and diameter: traction
/// `(P/sqrt T)(slip u_slip + gradient |u'|)`, dissipation `P sqrt(T) loss`.
#[derive(Debug, Clone, Copy)]
pub struct BumpIntegrals {
    /// Traction by slip.
    pub slip: f64,
    /// Traction by the velocity gradient.
    pub gradient: Jet,
    /// Dissipation.
    pub loss: f64,
}

impl Wall {
    /// Traction and dissipation for a Maxwellian with the first correction for shear, `sigma = (D + Dw)/2`:
    ///
    /// ```text
    /// M = (P/sqrt T) sqrt(8/pi) [a u_slip + b (1 + Bk) sigma |u'|],  loss = (1 - e_w) P sqrt(T) sqrt(2/pi) d
    /// disks:   a = (theta/sin - cos)/2,          b = sin^2/3,  d = theta/sin,
    ///          Bk = pi/(8 sqrt 2)(1 + 1/(v g0)) D/sigma
    /// spheres: a = [2(1 - cos)/sin^2 - cos]/3,   b = sin^2/4,  d = 2(1 - cos)/sin^2,
    ///          Bk = pi/(12 sqrt 2)(1 + 5/(8 v g0)) D/sigma
    /// ```
    pub fn bump_integrals(&self, grains: &GrainProperties, contact: Jet) -> BumpIntegrals {
        let (sin, cos) = self.theta.sin_cos();
        let sigma = 0.5 * (1.0 + self.diameter / grains.diameter);
        let (a, b, d, scale, dilute) = match self.shape {
            WallShape::Disk => {
                (0.5 * (self.theta / sin - cos), sin * sin / 3.0, self.theta / sin, PI / (8.0 * 2f64.sqrt()), 1.0)
            }
            WallShape::Sphere => {
                let d = 2.0 * (1.0 - cos) / (sin * sin);
                ((d - cos) / 3.0, sin * sin / 4.0, d, PI / (12.0 * 2f64.sqrt()), 0.625)
            }
        };
        let correction = (Jet::constant(dilute) / contact + 1.0) * (scale / sigma);
        let root = (8.0 / PI).sqrt();
        BumpIntegrals {
            slip: root * a,
            gradient: (correction + 1.0) * if self.gradient { root * b * sigma } else { 0.0 },
            loss: (1.0 - self.restitution) * (2.0 / PI).sqrt() * d,
        }
    }
}
