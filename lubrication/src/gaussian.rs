//! Stokes flow of Gaussian force densities in unbounded fluid, on the line through source and target.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_PI, PI};

/// `[f_1, f_2, f_3, f_4]` at distance `r`, with `f_n = (1/r d/dr)^n B`.
///
/// `B` is the biharmonic function of a Gaussian of standard deviation `width`,
/// `B = -1/(8 pi) [(r + s²/r) erf(r/(s sqrt 2)) + s sqrt(2/pi) exp(-r²/(2 s²))]`, and the mobility of a force density
/// is `T_ab = -delta_ab lap B + d_a d_b B` over the viscosity. Two envelopes of widths `s_1`, `s_2` act as one of width
/// `sqrt(s_1² + s_2²)`. The forms lose digits for `r` well below `s`, where spheres would overlap.
pub fn radial_derivatives(r: f64, width: f64) -> [f64; 4] {
    let (s2, r2) = (width * width, r * r);
    let e = libm::erf(r / width * FRAC_1_SQRT_2);
    let g = FRAC_2_PI.sqrt() / width * (-0.5 * r2 / s2).exp();
    let first = e * (1.0 - s2 / r2) / r + g * s2 / r2;
    let second = e * (3.0 * s2 / r2 - 1.0) / r.powi(3) - 3.0 * g * s2 / r.powi(4);
    let third = e * (3.0 - 15.0 * s2 / r2) / r.powi(5) + g * (2.0 + 15.0 * s2 / r2) / r.powi(4);
    let fourth = e * (105.0 * s2 / r2 - 15.0) / r.powi(7) - g * (20.0 + 105.0 * s2 / r2 + 2.0 * r2 / s2) / r.powi(6);
    [first, second, third, fourth].map(|f| -f / (8.0 * PI))
}

/// Standard deviations of a sphere's envelopes: of its force, and of its torque and stresslet (Maxey & Patel 2001;
/// Lomholt & Maxey 2003).
pub fn widths(radius: f64) -> [f64; 2] {
    [radius / PI.sqrt(), radius / (6.0 * PI.sqrt()).cbrt()]
}

/// Variances of the two Gaussians of the degenerate quadrupole of a sphere, and `1/e`: as `fcm::Quadrupole`, forces
/// `H/e` and `-H/e` with the variances `sigma'^2 +- e`, `e = sigma'^2/16`.
pub fn quadrupole(radius: f64) -> ([f64; 2], f64) {
    let variance = widths(radius)[1].powi(2);
    let half = variance / 16.0;
    ([variance + half, variance - half], 1.0 / half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_b() {
        let b = |r: f64, s: f64| {
            let (x, gauss) = (libm::erf(r / s * FRAC_1_SQRT_2), FRAC_2_PI.sqrt() * s * (-0.5 * r * r / (s * s)).exp());
            -((r + s * s / r) * x + gauss) / (8.0 * PI)
        };
        let (r, s, h) = (2.1, 0.9, 1e-4);
        let first = (b(r + h, s) - b(r - h, s)) / (2.0 * h * r);
        // Central differences: h² times a third derivative of order one.
        assert!((radial_derivatives(r, s)[0] - first).abs() < 1e-9);
        for n in 0..3 {
            let slope = (radial_derivatives(r + h, s)[n] - radial_derivatives(r - h, s)[n]) / (2.0 * h * r);
            assert!((radial_derivatives(r, s)[n + 1] - slope).abs() < 1e-8, "f_{}", n + 2);
        }
    }
}
