//! Moments of two spheres by dipoles.

use super::{PairMoments, PolarisablePair};
use std::f64::consts::PI;

/// Moments of two spheres in a uniform field, uniformly magnetised each. Each moment is `4/3 pi a^3 chi` times the mean
/// field in the sphere, so
///
/// ```text
/// (3/(4 pi a^3 chi) + 1/(4 pi a^3)) m - h m_other = H,
/// h = 2 / (4 pi r^3) along the line of centres, -1 / (4 pi r^3) across it.
/// ```
pub fn dipole_moments(pair: &PolarisablePair, distance: f64) -> PairMoments {
    let PolarisablePair { radii, susceptibilities } = *pair;
    let unit = 1.0 / (4.0 * PI * distance.powi(3));
    let own = [0, 1].map(|i| (3.0 / susceptibilities[i] + 1.0) / (4.0 * PI * radii[i].powi(3)));
    let moments = |h: f64| {
        let determinant = own[0] * own[1] - h * h;
        [(own[1] + h) / determinant, (own[0] + h) / determinant]
    };
    PairMoments { along: moments(2.0 * unit), across: moments(-unit) }
}
