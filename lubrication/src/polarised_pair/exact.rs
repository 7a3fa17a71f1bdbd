//! Exact moments of two spheres in a uniform field, in bispherical coordinates.

use super::{PairMoments, PolarisablePair};
use crate::two_sphere::tridiagonal::{BlockRow, solve};
use std::f64::consts::{PI, SQRT_2};

/// Terms below this, relative to the first one, are left out.
const SMALLEST: f64 = 1e-17;

/// Exact moments of two spheres in a uniform field; `distance` of the centres is more than the sum of their radii.
///
/// With bispherical coordinates `xi` and `eta`, `mu = cos(eta)`, the spheres are `xi = xi_1` and `xi = -xi_2`. The
/// potential outside of both is that of the field plus
///
/// ```text
/// (cosh xi - mu)^(1/2) sum_n [A_n exp((n + 1/2)(xi - xi_1)) + B_n exp(-(n + 1/2)(xi + xi_2))] P_n^m(mu) cos(m phi)
/// ```
///
/// with `m = 0` in a field along the line of centres and `m = 1` across it; within a sphere it is a sum of decaying
/// terms with the same values on its surface. Continuity of the flux gives two equations for each `n`, with unknowns
/// of `n - 1`, `n` and `n + 1` (Davis, Q. J. Mech. Appl. Math. 17, 499, 1964, for conductors). `A_n` are the sources
/// in the first sphere, whose moment is
///
/// ```text
/// m = 0: 8 sqrt(2) pi c^2 sum (n + 1/2) A_n exp(-(n + 1/2) xi_1),
/// m = 1: 4 sqrt(2) pi c^2 sum n (n + 1) A_n exp(-(n + 1/2) xi_1).
/// ```
pub fn exact_moments(pair: &PolarisablePair, distance: f64) -> PairMoments {
    let place = Bispherical::new(pair.radii, distance);
    let [along, across] = [0, 1].map(|order| place.moments(pair.susceptibilities, order));
    PairMoments { along, across }
}

/// Surfaces of two spheres in bispherical coordinates: `xi` of each, and the half-distance of the poles.
struct Bispherical {
    xi: [f64; 2],
    pole: f64,
}

impl Bispherical {
    fn new([a, b]: [f64; 2], distance: f64) -> Self {
        // Gaps may be small: (d - a)(d + a) with the distance d of the first centre from the plane xi = 0.
        let gap = distance - a - b;
        let beyond = gap * (gap + 2.0 * b) / (2.0 * distance);
        let pole = (beyond * (beyond + 2.0 * a)).sqrt();
        Self { xi: [a, b].map(|radius| (pole / radius).asinh()), pole }
    }

    /// Moments of both spheres over the field.
    fn moments(&self, susceptibilities: [f64; 2], order: usize) -> [f64; 2] {
        let Self { xi, pole } = *self;
        let count = (-SMALLEST.ln() / (xi[0].min(xi[1]) * 2.0)).ceil() as usize + 8;
        let mut rows: Vec<BlockRow> = (order..order + count).map(|n| self.row(susceptibilities, order, n)).collect();
        let amplitudes = solve(&mut rows);
        let mut sums = [0.0; 2];
        for (n, amplitudes) in (order..).zip(&amplitudes) {
            let weight = if order == 0 { 2 * n + 1 } else { n * (n + 1) } as f64;
            for sphere in 0..2 {
                sums[sphere] += weight * amplitudes[0][sphere].value() * (-(n as f64 + 0.5) * xi[sphere]).exp();
            }
        }
        let scale = 4.0 * SQRT_2 * PI * pole * pole;
        [sums[0] * scale, sums[1] * if order == 0 { -scale } else { scale }]
    }

    /// The two equations of degree `n`, projected on `P_n^m`.
    fn row(&self, susceptibilities: [f64; 2], order: usize, n: usize) -> BlockRow {
        let mut row = BlockRow::new(1);
        for sphere in 0..2 {
            let (chi, xi) = (susceptibilities[sphere], self.xi[sphere]);
            let terms = |n: usize| self.terms(sphere, chi, order, n);
            let (here, other) = (terms(n), 1 - sphere);
            let (cosh, half_sinh) = (xi.cosh(), 0.5 * xi.sinh());
            let middle = |k: usize| cosh * here.slopes[k] + half_sinh * here.values[k];
            (row.middle[sphere][sphere], row.middle[sphere][other]) = (middle(0).into(), middle(1).into());
            let mut right = middle(2);
            // mu P_n = [(n - m + 1) P_(n+1) + (n + m) P_(n-1)] / (2n + 1)
            if n > order {
                let (before, factor) = (terms(n - 1), (n - order) as f64 / (2 * n - 1) as f64);
                row.below[sphere][sphere] = (-factor * before.slopes[0]).into();
                row.below[sphere][other] = (-factor * before.slopes[1]).into();
                right -= factor * before.slopes[2];
            }
            let (after, factor) = (terms(n + 1), (n + order + 1) as f64 / (2 * n + 3) as f64);
            row.above[sphere][sphere] = (-factor * after.slopes[0]).into();
            row.above[sphere][other] = (-factor * after.slopes[1]).into();
            row.right[sphere][0] = (right - factor * after.slopes[2]).into();
        }
        row
    }

    /// Coefficients of the condition at a sphere, of its unknown, that of the other one, and the field:
    /// `(cosh xi - mu) sum slopes P_n + 1/2 sinh xi sum values P_n`.
    fn terms(&self, sphere: usize, chi: f64, order: usize, n: usize) -> FluxTerms {
        let degree = n as f64 + 0.5;
        let across = (-degree * (self.xi[0] + self.xi[1])).exp();
        let mirrored = if order == 0 && sphere == 1 { -1.0 } else { 1.0 };
        let weight = if order == 0 { 2.0 * degree } else { 2.0 };
        let field = mirrored * SQRT_2 * self.pole * weight * (-degree * self.xi[sphere]).exp();
        FluxTerms {
            slopes: [-(chi + 2.0) * degree, -chi * degree * across, -chi * degree * field],
            values: [chi, chi * across, chi * field],
        }
    }
}

/// See [`Bispherical::terms`].
struct FluxTerms {
    slopes: [f64; 3],
    values: [f64; 3],
}
