//! Gaussian envelopes, and the wide Gaussian that all particles share in the split method.

use std::f64::consts::PI;

/// Widths of a sphere's two Gaussians: `sigma = a / sqrt(pi)` for its force and `sigma' = a / (6 sqrt(pi))^(1/3)` for
/// its torque and stresslet (Maxey & Patel 2001; Lomholt & Maxey 2003). With them a single sphere has Stokes' drag,
/// and, with no rate of strain within it, the stresslet `20/3 pi mu a^3 E`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Envelope {
    /// Width of the force's Gaussian.
    pub monopole: f64,
    /// Width of the dipole's Gaussian.
    pub dipole: f64,
}

impl Envelope {
    /// Envelope of a point of the fluid.
    pub const POINT: Self = Self { monopole: 0.0, dipole: 0.0 };

    /// Envelope of a sphere.
    pub fn of_sphere(radius: f64) -> Self {
        Self { monopole: radius / PI.sqrt(), dipole: radius / (6.0 * PI.sqrt()).cbrt() }
    }

    /// Gaussians of the degenerate quadrupole of a sphere.
    pub fn quadrupole(&self) -> Quadrupole {
        let variance = self.dipole * self.dipole;
        let half = variance * VARIANCE_STEP;
        Quadrupole { variances: [variance + half, variance - half], weight: 1.0 / half }
    }
}

/// Step in the variance of the Gaussian of a quadrupole, over the variance.
const VARIANCE_STEP: f64 = 1.0 / 16.0;

/// Gaussians of a degenerate quadrupole `H`: its force density is
///
/// ```text
/// H (Delta_+ - Delta_-) / e,      variances of Delta_(+-): sigma'^2 +- e,     e = sigma'^2 / 16
/// ```
///
/// Since a Gaussian has `d Delta / d(sigma^2) = 1/2 lap Delta`, this is the central difference of `H lap Delta'` with
/// the width `sigma'` of dipoles (Delmotte, Keaveny, Plouraboue & Climent 2015). It differs from it by a factor `1 +
/// (e k^2)^2 / 24` in Fourier space, so the far field is the same, and it consists of forces, so that all methods that
/// evaluate forces evaluate it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quadrupole {
    /// Variances of the two Gaussians, the wider one first.
    pub variances: [f64; 2],
    /// `1/e`: forces of the Gaussians are `H/e` and `-H/e`.
    pub weight: f64,
}

impl Quadrupole {
    /// Velocity of the sphere itself in unbounded fluid over `H / mu`, averaged over the envelope of its force. With
    /// `s^2` the sum of two variances, a force `F` gives `F / (3 pi^2 mu s) sqrt(pi/2)`.
    pub fn own_mobility(&self, monopole: f64) -> f64 {
        let [wide, narrow] = self.variances.map(|variance| (variance + monopole * monopole).sqrt().recip());
        self.weight * (wide - narrow) * (0.5 * PI).sqrt() / (3.0 * PI * PI)
    }

    /// The two Gaussians as envelopes of forces.
    pub(crate) fn envelopes(&self) -> [Envelope; 2] {
        self.variances.map(|variance| Envelope { monopole: variance.sqrt(), dipole: variance.sqrt() })
    }
}

/// Gaussian that the direct method spreads for one multipole, `peak exp(-r^2 / (2 width^2))`: the envelope itself for
/// a monopole, the factor of `x_j` in its gradient for a dipole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Source {
    /// Width of the Gaussian.
    pub width: f64,
    /// Value at the centre.
    pub peak: f64,
}

impl Source {
    /// The envelope of a monopole.
    pub fn monopole(width: f64) -> Self {
        Self { width, peak: (2.0 * PI * width * width).powf(-1.5) }
    }

    /// Factor of `x_j` in the gradient of the envelope.
    pub fn dipole(width: f64) -> Self {
        Self { width, peak: -Self::monopole(width).peak / (width * width) }
    }
}

/// Function that the split method spreads in place of the envelopes:
///
/// ```text
/// w(k) = (1 + k^2 D/2) (1 + k^2 (d - D)/2) exp(-k^2 Sigma^2 / 2),     d = Sigma^2 - sigma^2
/// ```
///
/// for an envelope of width `sigma`. It agrees with `exp(-k^2 sigma^2 / 2)` to `O(k^4)`, so the far field is that of
/// the envelope. The Gaussian and the first bracket are common to all envelopes and applied in Fourier space; the
/// second is `1 - (d - D)/2 lap` on the grid, and absent if `d = D`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Common {
    /// `Sigma`
    pub width: f64,
    /// `D`
    pub increment: f64,
}

impl Common {
    /// With `D` three quarters of the way from the value for the narrowest of the given envelopes to that for the
    /// widest, whose dipoles are the largest.
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
