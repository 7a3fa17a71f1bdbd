//! Near-contact singularities of the resistance functions.
//!
//! With `xi = 2 gap/(a1 + a2)`, a function behaves like `g1/xi + g2 ln(1/xi) + regular + g3 xi ln(1/xi)`.
//! Coefficients for `lambda = a2/a1`: Jeffrey & Onishi (1984) eqs. (3.17)-(3.23), (4.15)-(4.18), (5.6), (7.10), and
//! section 6 for XC; Jeffrey (1992) eqs. (19b), (27b), (35b), (48b), (64b), (79b); with the corrections of Townsend
//! (2023), Phys. Fluids 35, 127126.
//!
//! In the last coefficient of YM12, 748 replaces the 728 that the sources print twice: only then does the exact
//! function minus these terms have no term in `xi ln xi` (verified at ratios 1, 2, 2.5 and 4, to 7 digits).

use super::functions::Function;

/// `[g1, g2, g3]`.
pub type Singularity = [f64; 3];

/// Singularity of the load on the first sphere by its own motion.
pub fn own(function: Function, l: f64) -> Singularity {
    let d1 = 1.0 / (1.0 + l);
    let (d2, d3) = (d1 * d1, d1 * d1 * d1);
    match function {
        Function::XA => {
            [2.0 * l * l * d3, l * poly(l, &[1., 7., 1.]) / 5.0 * d3, poly(l, &[1., 18., -29., 18., 1.]) / 42.0 * d3]
        }
        Function::YA => [
            0.0,
            4.0 * l * poly(l, &[2., 1., 2.]) / 15.0 * d3,
            2.0 * poly(l, &[16., -45., 58., -45., 16.]) / 375.0 * d3,
        ],
        Function::YB => [0.0, -l * (4.0 + l) / 5.0 * d2, -poly(l, &[32., -33., 83., 43.]) / 250.0 * d2],
        Function::XC => [0.0, 0.0, -l * l / 4.0 * d1],
        Function::YC => [0.0, 2.0 * l / 5.0 * d1, poly(l, &[8., 6., 33.]) / 125.0 * d1],
        Function::XG => [
            3.0 * l * l * d3,
            0.3 * l * poly(l, &[1., 12., -4.]) * d3,
            poly(l, &[5., 181., -453., 566., -65.]) / 140.0 * d3,
        ],
        Function::YG => {
            [0.0, l * poly(l, &[4., -1., 7.]) / 10.0 * d3, poly(l, &[32., -179., 532., -356., 221.]) / 500.0 * d3]
        }
        Function::YH => [0.0, l * (2.0 - l) / 10.0 * d2, poly(l, &[16., -61., 180., 2.]) / 500.0 * d2],
        Function::XM => [
            1.2 * l * l * d3,
            0.12 * l * poly(l, &[1., 17., -9.]) * d3,
            poly(l, &[5., 272., -831., 1322., -415.]) / 350.0 * d3,
        ],
        Function::YM => {
            [0.0, 0.24 * l * poly(l, &[1., -1., 4.]) * d3, poly(l, &[24., -201., 882., -1182., 591.]) / 625.0 * d3]
        }
        Function::ZM => [0.0, 0.0, -0.3 * (l * l + l.powi(4)) * d3],
    }
}

/// Singularity of the load on the first sphere by the motion of the second.
pub fn other(function: Function, l: f64) -> Singularity {
    let d1 = 1.0 / (1.0 + l);
    let (d2, d3) = (d1 * d1, d1 * d1 * d1);
    let series = match function {
        Function::YC => [0.0, l * l / 10.0 * d1, l * poly(l, &[43., -24., 43.]) / 500.0 * d1],
        Function::YH => {
            [0.0, l * l * (1.0 + 7.0 * l) / 20.0 * d2, l * poly(l, &[43., 147., -185., 221.]) / 1000.0 * d2]
        }
        Function::XM => [
            1.2 * l.powi(3) * d3,
            0.12 * l * l * poly(l, &[-4., 17., -4.]) * d3,
            l * poly(l, &[-65., 832., -1041., 832., -65.]) / 350.0 * d3,
        ],
        Function::YM => [
            0.0,
            0.06 * l * l * poly(l, &[7., -10., 7.]) * d3,
            3.0 * l * poly(l, &[221., -748., 1902., -748., 221.]) / 2500.0 * d3,
        ],
        _ => own(function, l),
    };
    // Hatted normalisation, with the mean radius in place of the first one.
    let hat = match function {
        Function::XA | Function::YA => -2.0 * d1,
        Function::YB | Function::XG | Function::YG => -4.0 * d2,
        Function::XC | Function::ZM => -8.0 * d3,
        Function::YC | Function::YH | Function::XM | Function::YM => 8.0 * d3,
    };
    series.map(|g| g * hat)
}

/// Singularity of the load on a sphere by its own motion at a wall, in powers of the gap over its radius, `h`: the
/// limit of [`own`] for a large second sphere, where `xi = 2 h/(1 + lambda)` vanishes for any `h`. The remaining
/// logarithm of the ratio is a constant, part of the regular terms.
pub fn at_wall(function: Function) -> Singularity {
    match function {
        Function::XA => [1.0, 1.0 / 5.0, 1.0 / 21.0],
        Function::YA => [0.0, 8.0 / 15.0, 64.0 / 375.0],
        Function::YB => [0.0, -1.0 / 5.0, -43.0 / 125.0],
        Function::XC => [0.0, 0.0, -1.0 / 2.0],
        Function::YC => [0.0, 2.0 / 5.0, 66.0 / 125.0],
        Function::XG => [3.0 / 2.0, -6.0 / 5.0, -13.0 / 14.0],
        Function::YG => [0.0, 7.0 / 10.0, 221.0 / 250.0],
        Function::YH => [0.0, -1.0 / 10.0, 1.0 / 125.0],
        Function::XM => [3.0 / 5.0, -27.0 / 25.0, -83.0 / 35.0],
        Function::YM => [0.0, 24.0 / 25.0, 1182.0 / 625.0],
        Function::ZM => [0.0, 0.0, -3.0 / 5.0],
    }
}

fn poly(x: f64, coefficients: &[f64]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `g1/xi`, `g2 ln(1/xi)` and `g3 xi ln(1/xi)` with `xi = 2 h/(1 + lambda)`: at a ratio of 1e7 the limit is
    /// reached to one part in 1e7 times the largest coefficient of a polynomial, 1322.
    #[test]
    fn a_wall_is_a_sphere_of_any_large_radius() {
        let ratio = 1e7;
        for function in Function::ALL {
            let [g1, g2, g3] = own(function, ratio);
            let limit = [g1 * (1.0 + ratio) / 2.0, g2, g3 * 2.0 / (1.0 + ratio)];
            for (found, limit) in at_wall(function).into_iter().zip(limit) {
                assert!((found - limit).abs() < 2e-5, "{function:?}: {found}, not {limit}");
            }
        }
    }
}
