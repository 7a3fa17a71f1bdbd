//! Gaussian envelopes and what they become when all particles share one wide Gaussian.

use std::f64::consts::PI;

/// The widths of a sphere's two Gaussians: `sigma = a / sqrt(pi)` for its force and `sigma' = a / (6 sqrt(pi))^(1/3)`
/// for its torque and stresslet (Maxey & Patel 2001; Lomholt & Maxey 2003). With them a single sphere has Stokes' drag,
/// and, at no strain within it, the stresslet `20/3 pi mu a^3 E`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Envelope {
    /// Width of the force's Gaussian.
    pub monopole: f64,
    /// Width of the dipole's Gaussian.
    pub dipole: f64,
}

impl Envelope {
    /// The envelopes of a sphere of the given radius.
    pub fn of_sphere(radius: f64) -> Self {
        Self { monopole: radius / PI.sqrt(), dipole: radius / (6.0 * PI.sqrt()).cbrt() }
    }
}

/// What is spread for one multipole: `(constant + quadratic r^2) exp(-r^2 / (2 width^2))`, for a monopole the envelope
/// itself, for a dipole the factor of `x_j` in its gradient.
///
/// A particle whose envelope has the width `sigma` may be spread with a wider Gaussian `Sigma` if the far field is
/// restored: `w(k) = (1 + k^2 d / 2) exp(-k^2 Sigma^2 / 2)`, `d = Sigma^2 - sigma^2`, agrees with
/// `exp(-k^2 sigma^2 / 2)` to `O(k^4)`. With `Sigma = sigma` it is the envelope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Source {
    /// Width of the Gaussian on the grid.
    pub width: f64,
    /// Coefficient of 1.
    pub constant: f64,
    /// Coefficient of r^2.
    pub quadratic: f64,
}

impl Source {
    /// `(1 - d/2 lap) Delta_Sigma = Delta_Sigma (1 + d/2 (3/Sigma^2 - r^2/Sigma^4))`.
    pub fn monopole(sigma: f64, width: f64) -> Self {
        let (d, square) = (width * width - sigma * sigma, width * width);
        let peak = (2.0 * PI * square).powf(-1.5);
        Self { width, constant: peak * (1.0 + 1.5 * d / square), quadratic: -peak * 0.5 * d / (square * square) }
    }

    /// The factor of `x_j` in `d_j (1 - d/2 lap) Delta_Sigma`.
    pub fn dipole(sigma: f64, width: f64) -> Self {
        let base = Self::monopole(sigma, width);
        let square = width * width;
        Self { width, constant: 2.0 * base.quadratic - base.constant / square, quadratic: -base.quadratic / square }
    }
}
