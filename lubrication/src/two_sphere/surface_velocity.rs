//! Velocities on the surface of a sphere, as series of bispherical harmonics.

use super::double_double::DoubleDouble;
use super::geometry::{Geometry, side};
use super::normal_polynomial::NormalPolynomial;

/// Velocity on one sphere: coefficients of `v_z`, `(v_rho + v_phi)/2`, `(v_rho - v_phi)/2` over `sqrt 2`, in the basis
/// of [`super::bispherical`].
#[derive(Debug, Clone, Copy)]
pub struct SurfaceVelocity {
    /// Sphere that moves, 0 or 1; the other one is at rest.
    pub sphere: usize,
    /// `v_z`, of order `m`.
    pub axial: SurfaceFunction,
    /// `(v_rho + v_phi)/2`, of order `m + 1`.
    pub raised: SurfaceFunction,
    /// `(v_rho - v_phi)/2`, of order `m - 1`.
    pub lowered: SurfaceFunction,
}

/// A function on a sphere.
#[derive(Debug, Clone, Copy)]
pub enum SurfaceFunction {
    /// 0
    Zero,
    /// 1, of order 0
    One,
    /// `z - z_i`, of order 0
    Height,
    /// A multiple of `rho`, of order 1
    Radius(f64),
    /// A polynomial of the normal
    Normal(NormalPolynomial),
}

impl SurfaceFunction {
    /// Coefficient of degree `n` over `sqrt 2`, given `exp(-(n+1/2) alpha)`.
    #[inline(always)]
    pub fn coefficient(self, n: usize, decay: DoubleDouble, geometry: &Geometry, sphere: usize) -> DoubleDouble {
        match self {
            Self::Zero => DoubleDouble::default(),
            Self::One => decay,
            Self::Height => {
                let side = decay * side(sphere);
                side * (2 * n + 1) as f64 - side * geometry.cosh[sphere] / geometry.sinh[sphere]
            }
            Self::Radius(factor) => decay * (2.0 * factor),
            Self::Normal(polynomial) => polynomial.coefficient(n, decay, geometry, sphere),
        }
    }
}
