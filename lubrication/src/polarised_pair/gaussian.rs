//! Moments of two spheres by dipoles with Gaussian envelopes.

use super::{PairMoments, PolarisablePair};
use crate::gaussian::widths;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_PI, PI};

/// Moments of two spheres in a uniform field by the force-coupling method, with envelopes of width `sigma'`.
/// Each is `4/3 pi a^3 chi` times the field averaged over its envelope, so with `psi = erf(r / (sqrt(2) s)) / (4 pi r)`
/// and `s^2` the sum of both variances,
///
/// ```text
/// (3/(4 pi a^3 chi) + 1/(4 pi a^3)) m - h m_other = H,      h = psi'' along the line of centres, psi'/r across it.
/// ```
pub fn gaussian_moments(pair: &PolarisablePair, distance: f64) -> PairMoments {
    let PolarisablePair { radii, susceptibilities } = *pair;
    let width = widths(radii[0])[1].hypot(widths(radii[1])[1]);
    let r = distance;
    let (e, g) = (libm::erf(r / width * FRAC_1_SQRT_2), FRAC_2_PI.sqrt() / width * (-0.5 * (r / width).powi(2)).exp());
    let slope = (g - e / r) / (4.0 * PI * r);
    let curvature = (2.0 * e / r - 2.0 * g - g * (r / width).powi(2)) / (4.0 * PI * r * r);
    let own = [0, 1].map(|i| (3.0 / susceptibilities[i] + 1.0) / (4.0 * PI * radii[i].powi(3)));
    let moments = |h: f64| {
        let determinant = own[0] * own[1] - h * h;
        [(own[1] + h) / determinant, (own[0] + h) / determinant]
    };
    PairMoments { along: moments(curvature), across: moments(slope / r) }
}
