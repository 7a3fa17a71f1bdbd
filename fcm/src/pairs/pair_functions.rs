//! Radial functions of the pair correction: the difference between two envelopes and two wide Gaussians on the grid.

use crate::envelope::{Common, Quadrupole};
use crate::pairs::boys::boys;
use std::f64::consts::PI;

/// Highest order of [`EnvelopeDifference::evaluate`] plus one.
pub(crate) const ORDERS: usize = 11;

/// Radial function `B(r)` whose transform is `[exp(-k^2 s^2 / 2) - w_i(k) w_j(k)] / k^4`, with `s^2` the sum of the
/// variances of the two envelopes and the `w` of [`Common`]. The bracket is `O(k^4)`, so `B` decays like a Gaussian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EnvelopeDifference {
    /// Sum of the variances of the two envelopes, or two such sums.
    variances: Variances,
    /// `2 Sigma^2`.
    wide_variance: f64,
    /// Coefficients of `w_i w_j` over the Gaussian, by powers of `k^2`.
    polynomial: [f64; 5],
}

/// Gaussians in the transform of a radial function.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Variances {
    /// One of this variance.
    One(f64),
    /// The difference of two, times a weight.
    Difference { of: [f64; 2], weight: f64 },
}

impl EnvelopeDifference {
    /// For two envelopes of widths `sigma`.
    pub fn new(sigma: [f64; 2], common: Common) -> Self {
        let mut polynomial = [1.0, 0.0, 0.0, 0.0, 0.0];
        for increment in [common.increment, common.increment, common.rest(sigma[0]), common.rest(sigma[1])] {
            for power in (1..5).rev() {
                polynomial[power] += 0.5 * increment * polynomial[power - 1];
            }
        }
        let variance = sigma[0] * sigma[0] + sigma[1] * sigma[1];
        let variances = Variances::One(variance);
        Self { variances, wide_variance: 2.0 * common.width * common.width, polynomial }
    }

    /// For the envelope of width `sigma` of a target and the degenerate quadrupole of a source: the difference of the
    /// radial functions of its two Gaussians, times their weight. On the grid the Gaussians differ by the bracket of
    /// [`Common`] alone, which leaves `-k^2`.
    pub fn of_quadrupole(sigma: f64, source: &Quadrupole, common: Common) -> Self {
        let of = source.variances.map(|variance| variance + sigma * sigma);
        let mut polynomial = [0.0, -1.0, 0.0, 0.0, 0.0];
        for increment in [common.increment, common.increment, common.rest(sigma)] {
            for power in (1..5).rev() {
                polynomial[power] += 0.5 * increment * polynomial[power - 1];
            }
        }
        let variances = Variances::Difference { of, weight: source.weight };
        Self { variances, wide_variance: 2.0 * common.width * common.width, polynomial }
    }

    /// `f_n = (1/r d/dr)^n B` at `r^2 = square`, for `n = 1..ORDERS` (entry 0 is not used and zero).
    ///
    /// With `x = r^2 / (2 s^2)` and Boys' functions, the transforms `exp(-k^2 s^2 / 2) / k^p` have
    /// `p = 4: (-1)^n (F_(n-1) - F_n) s^(1-2n) / 2`, `p = 2: (-1)^n F_n s^(-1-2n)`,
    /// `p = 0: (-1)^n exp(-x) s^(-3-2n)`, each over `(2 pi)^(3/2)`. Higher powers of `k^2` follow as Laplacians.
    pub fn evaluate(&self, square: f64) -> [f64; ORDERS] {
        let near = self.variances.over_k4(square);
        let wide = Gaussian::new(square, self.wide_variance);
        let mut f = [0.0; ORDERS];
        for (n, value) in f.iter_mut().enumerate().skip(1) {
            let [a, b, c, d, e] = self.polynomial;
            let smooth = c * wide.itself(n) + d * wide.times_k2(n) + e * wide.times_k4(n);
            *value = near[n] - (a * wide.over_k4(n) + b * wide.over_k2(n) + smooth);
        }
        f
    }
}

impl Variances {
    /// `(1/r d/dr)^n` of the inverse transform of the Gaussians over `k^4`.
    fn over_k4(&self, square: f64) -> [f64; ORDERS] {
        let of_one = |variance: f64| {
            let gaussian = Gaussian::new(square, variance);
            std::array::from_fn(|n| if n == 0 { 0.0 } else { gaussian.over_k4(n) })
        };
        match *self {
            Self::One(variance) => of_one(variance),
            Self::Difference { of: [wide, narrow], weight } => {
                let (wide, narrow) = (of_one(wide), of_one(narrow));
                std::array::from_fn(|n| weight * (wide[n] - narrow[n]))
            }
        }
    }
}

/// Radial function `psi(r)` whose transform is `exp(-k^2 Sigma^2) / k^2`: the potential of a unit charge with an
/// envelope of width `Sigma`, averaged over another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GaussianPotential {
    /// `2 Sigma^2`.
    variance: f64,
}

impl GaussianPotential {
    /// For envelopes of this width.
    pub fn new(width: f64) -> Self {
        Self { variance: 2.0 * width * width }
    }

    /// `psi_n = (1/r d/dr)^n psi` at `r^2 = square`, for `n = 0..ORDERS`.
    pub fn evaluate(self, square: f64) -> [f64; ORDERS] {
        let gaussian = Gaussian::new(square, self.variance);
        std::array::from_fn(|n| gaussian.over_k2(n))
    }
}

/// `(1/r d/dr)^n` of the inverse transforms of `exp(-k^2 s^2 / 2) / k^p` at one distance.
struct Gaussian {
    boys: [f64; ORDERS],
    decay: f64,
    /// `r^2 / s^2`
    square: f64,
    /// `(2 pi)^(-3/2) (-1)^n s^(1 - 2n)`.
    scale: [f64; ORDERS],
    variance: f64,
}

impl Gaussian {
    fn new(square: f64, variance: f64) -> Self {
        let x = square / (2.0 * variance);
        let mut scale = [(2.0 * PI).powf(-1.5) * variance.sqrt(); ORDERS];
        for n in 1..ORDERS {
            scale[n] = -scale[n - 1] / variance;
        }
        Self { boys: boys(x), decay: (-x).exp(), square: square / variance, scale, variance }
    }

    fn over_k4(&self, n: usize) -> f64 {
        0.5 * self.scale[n] * (self.boys[n - 1] - self.boys[n])
    }

    fn over_k2(&self, n: usize) -> f64 {
        self.scale[n] * self.boys[n] / self.variance
    }

    fn itself(&self, n: usize) -> f64 {
        self.scale[n] * self.decay / (self.variance * self.variance)
    }

    /// `-lap` of a Gaussian: with `g_n = (1/r d/dr)^n g`, `lap g = 3 g_1 + r^2 g_2`, whose `n`-th derivative is
    /// `(3 + 2n) g_(n+1) + r^2 g_(n+2)`, and `g_(n+1) = -g_n / s^2`.
    fn times_k2(&self, n: usize) -> f64 {
        self.itself(n) * ((3 + 2 * n) as f64 - self.square) / self.variance
    }

    /// `lap^2` of a Gaussian.
    fn times_k4(&self, n: usize) -> f64 {
        let (next, last) = ((5 + 2 * n) as f64, (3 + 2 * n) as f64);
        let polynomial = next * last - 2.0 * next * self.square + self.square * self.square;
        self.itself(n) * polynomial / (self.variance * self.variance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envelope::Envelope;

    /// The radial function of a quadrupole is the weighted difference of those of its two Gaussians.
    #[test]
    fn a_quadrupole_is_the_difference_of_two_forces() {
        let (common, quadrupole) = (Common { width: 1.4, increment: 1.1 }, Envelope::of_sphere(1.0).quadrupole());
        for square in [0.0, 0.7, 4.0, 11.0] {
            let found = EnvelopeDifference::of_quadrupole(0.6, &quadrupole, common).evaluate(square);
            let [wide, narrow] =
                quadrupole.variances.map(|v| EnvelopeDifference::new([0.6, v.sqrt()], common).evaluate(square));
            for n in 1..ORDERS {
                let exact = quadrupole.weight * (wide[n] - narrow[n]);
                assert!((found[n] - exact).abs() < 1e-9 * exact.abs(), "{n} at {square}: {}, not {exact}", found[n]);
            }
        }
    }

    /// `f_n = (-1)^n / (2 pi^2) int k^(2n+2) [bracket]/k^4 j_n(kr)/(kr)^n dk` by the trapezoidal rule, which
    /// converges geometrically for this integrand.
    fn by_quadrature(d: &EnvelopeDifference, n: usize, r: f64) -> f64 {
        let step = 0.01;
        let mut sum = 0.0;
        for i in 1..4000 {
            let k = f64::from(i) * step;
            let q = k * k;
            let near = match d.variances {
                Variances::One(variance) => (-0.5 * q * variance).exp(),
                Variances::Difference { of, weight } => {
                    let [wide, narrow] = of.map(|variance| (-0.5 * q * variance).exp());
                    weight * (wide - narrow)
                }
            };
            let bracket = near - polynomial(d, q) * (-0.5 * q * d.wide_variance).exp();
            sum += bracket * k.powi(2 * n as i32 - 2) * bessel(n, k * r) * step;
        }
        sum * (-1.0_f64).powi(n as i32) / (2.0 * PI * PI)
    }

    fn polynomial(d: &EnvelopeDifference, square: f64) -> f64 {
        d.polynomial.iter().rev().fold(0.0, |sum, coefficient| sum * square + coefficient)
    }

    /// `j_n(x) / x^n` by its series.
    fn bessel(n: usize, x: f64) -> f64 {
        if x > 12.0 {
            let (mut low, mut high) = (x.sin() / x, x.sin() / (x * x) - x.cos() / x);
            for m in 1..n {
                (low, high) = (high, (2 * m + 1) as f64 / x * high - low);
            }
            return if n == 0 { low } else { high } / x.powi(n as i32);
        }
        let mut term: f64 = (0..=n).map(|m| 1.0 / (2 * m + 1) as f64).product();
        let mut sum = term;
        for m in 1..80 {
            term *= -x * x / (2 * m * (2 * n + 2 * m + 1)) as f64;
            sum += term;
        }
        sum
    }

    #[test]
    fn closed_forms_are_the_inverse_transforms() {
        let common = Common { width: 1.1, increment: 0.7 };
        let quadrupole = Envelope::of_sphere(1.3).quadrupole();
        let all = [
            EnvelopeDifference::new([0.5, 0.5], common),
            EnvelopeDifference::new([0.45, 0.9], common),
            EnvelopeDifference::of_quadrupole(0.5, &quadrupole, common),
        ];
        for difference in all {
            for r in [0.05, 0.6, 1.3, 2.0, 3.5] {
                let found = difference.evaluate(r * r);
                for n in 1..5 {
                    let exact = by_quadrature(&difference, n, r);
                    let scale = difference.evaluate(0.0)[n].abs();
                    assert!((found[n] - exact).abs() < 1e-11 * scale, "f_{n}({r}) = {}, not {exact}", found[n]);
                }
            }
        }
    }

    /// `psi_0 = erf(r / (2 Sigma)) / (4 pi r)`, and each function is the slope of the former.
    #[test]
    fn potentials_are_those_of_gaussian_charges() {
        let width = 1.3;
        let potential = GaussianPotential::new(width);
        for r in [0.3_f64, 1.0, 2.5, 4.0] {
            let exact = libm::erf(r / (2.0 * width)) / (4.0 * PI * r);
            assert!((potential.evaluate(r * r)[0] - exact).abs() < 1e-14, "at {r}");
            let step = 1e-4;
            let [before, here, after] = [r - step, r, r + step].map(|r| potential.evaluate(r * r));
            for n in 0..4 {
                let slope = (after[n] - before[n]) / (2.0 * step * r);
                assert!((slope - here[n + 1]).abs() < 1e-6, "psi_{} at {r}: {} and {slope}", n + 1, here[n + 1]);
            }
        }
    }

    #[test]
    fn nothing_is_left_when_the_gaussians_agree() {
        assert!(
            EnvelopeDifference::new([0.7, 0.7], Common { width: 0.7, increment: 0.0 })
                .evaluate(2.0)
                .iter()
                .all(|f| f.abs() < 1e-16)
        );
    }

    #[test]
    fn they_decay_like_a_gaussian() {
        let difference = EnvelopeDifference::new([0.5, 0.6], Common { width: 1.0, increment: 0.7 });
        let first = difference.evaluate(0.0)[1].abs();
        assert!(difference.evaluate(25.0)[1].abs() < 5e-3 * first);
        assert!(difference.evaluate(100.0)[1].abs() < 1e-10 * first);
    }
}
