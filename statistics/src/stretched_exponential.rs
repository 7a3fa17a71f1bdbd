//! Fits of a stretched exponential to probability densities.

use crate::Histogram;

/// Probability density of a normalised number,
///
/// ```text
/// p(x) = n / (2 l Gamma(1/n)) exp(-|x / l|^n),
/// ```
///
/// a Gaussian for `n = 2`, an exponential for `n = 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StretchedExponential {
    /// Exponent `n`.
    pub exponent: f64,
    /// Scale `l`, over the standard deviation of the numbers.
    pub scale: f64,
}

/// Range of exponents that is searched.
const EXPONENTS: [f64; 2] = [0.2, 8.0];

impl StretchedExponential {
    /// Maximum likelihood fit to a histogram; `None` for fewer than two different numbers.
    ///
    /// At a given `n` the most likely scale is `l^n = n <|x|^n>`, and the likelihood at that scale is maximised over
    /// `n` by golden-section search.
    pub fn fitted(histogram: &Histogram) -> Option<Self> {
        let deviation = histogram.standard_deviation();
        if deviation.is_nan() || deviation == 0.0 {
            return None;
        }
        let numbers: Vec<(f64, f64)> = histogram.counts().iter().map(|(x, n)| (x.abs() / deviation, *n)).collect();
        let total = histogram.count();
        let scale =
            |n: f64| (n / total * numbers.iter().map(|(x, count)| count * x.powf(n)).sum::<f64>()).powf(1.0 / n);
        let likelihood = |n: f64| n.ln() - scale(n).ln() - libm::lgamma(1.0 / n) - 1.0 / n;
        let exponent = maximum(likelihood, EXPONENTS);
        Some(Self { exponent, scale: scale(exponent) })
    }

    /// Density at a number over the standard deviation.
    pub fn density(&self, x: f64) -> f64 {
        let Self { exponent: n, scale: l } = self;
        n / (2.0 * l * libm::tgamma(1.0 / n)) * (-(x.abs() / l).powf(*n)).exp()
    }
}

/// Position of the maximum of a unimodal function between two numbers, by golden-section search: within 3e-13 of their
/// distance, or as near as round-off tells the values apart.
pub fn maximum(f: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..60 {
        let step = ratio * (high - low);
        if f(high - step) > f(low + step) {
            high = low + step;
        } else {
            low = high - step;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Random;

    fn fitted(number: impl Fn(&mut Random) -> f64) -> StretchedExponential {
        let mut histogram = Histogram::default();
        let mut random = Random::new(5, 5);
        for _ in 0..200_000 {
            histogram.add(number(&mut random));
        }
        StretchedExponential::fitted(&histogram).unwrap()
    }

    #[test]
    fn exponential_and_gaussian_numbers_are_told_apart() {
        let exponential = fitted(|r| 3.0 * (1.0 - r.uniform()).ln() * if r.uniform() < 0.5 { 1.0 } else { -1.0 });
        // The standard deviation of a Laplace density is sqrt(2) times its scale.
        assert!((exponential.exponent - 1.0).abs() < 0.02, "{exponential:?}");
        assert!((exponential.scale - 0.5_f64.sqrt()).abs() < 0.02, "{exponential:?}");
        let pair =
            |r: &mut Random| (-2.0 * (1.0 - r.uniform()).ln()).sqrt() * (std::f64::consts::TAU * r.uniform()).cos();
        let gaussian = fitted(|r| 0.2 * pair(r));
        assert!((gaussian.exponent - 2.0).abs() < 0.03, "{gaussian:?}");
        assert!((gaussian.density(0.0) - 1.0 / std::f64::consts::TAU.sqrt()).abs() < 0.01);
    }

    #[test]
    fn equal_numbers_have_no_tails() {
        let mut histogram = Histogram::default();
        assert_eq!(StretchedExponential::fitted(&histogram), None);
        histogram.add(1.0);
        assert_eq!(StretchedExponential::fitted(&histogram), None);
    }
}
