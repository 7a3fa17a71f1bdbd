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
    /// That of a point of the fluid.
    pub const POINT: Self = Self { monopole: 0.0, dipole: 0.0 };

    /// The envelopes of a sphere of the given radius.
    pub fn of_sphere(radius: f64) -> Self {
        Self { monopole: radius / PI.sqrt(), dipole: radius / (6.0 * PI.sqrt()).cbrt() }
    }
}

/// What the direct method spreads for one multipole: `peak exp(-r^2 / (2 width^2))`, for a monopole the envelope
/// itself, for a dipole the factor of `x_j` in its gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Source {
    /// Width of the Gaussian.
    pub width: f64,
    /// Its value at the centre.
    pub peak: f64,
}

impl Source {
    /// The envelope.
    pub fn monopole(width: f64) -> Self {
        Self { width, peak: (2.0 * PI * width * width).powf(-1.5) }
    }

    /// The factor of `x_j` in its gradient.
    pub fn dipole(width: f64) -> Self {
        Self { width, peak: -Self::monopole(width).peak / (width * width) }
    }
}

/// What the split method spreads in place of every envelope:
///
/// ```text
/// w(k) = (1 + k^2 D/2) (1 + k^2 (d - D)/2) exp(-k^2 Sigma^2 / 2),     d = Sigma^2 - sigma^2
/// ```
///
/// for an envelope of width `sigma`. It agrees with `exp(-k^2 sigma^2 / 2)` to `O(k^4)`: the far field is that of the
/// envelope. The Gaussian and the first bracket are common to all envelopes and left to the spectrum; the second is
/// `1 - (d - D)/2 lap` on the grid, and nothing at all where `d = D`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Common {
    /// `Sigma`
    pub width: f64,
    /// `D`
    pub increment: f64,
}

impl Common {
    /// With `D` three quarters of the way from that of the narrowest of the given envelopes to that of the widest,
    /// whose dipoles are the largest.
    pub fn new(width: f64, envelopes: impl Iterator<Item = f64> + Clone) -> Self {
        let least = envelopes.clone().fold(f64::INFINITY, f64::min);
        let most = envelopes.fold(0.0, f64::max);
        Self { width, increment: width * width - 0.25 * least * least - 0.75 * most * most }
    }

    /// `d - D` of an envelope.
    pub fn rest(&self, sigma: f64) -> f64 {
        self.width * self.width - sigma * sigma - self.increment
    }
}
