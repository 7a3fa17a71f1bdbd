//! Student's t distribution.

/// Probability that a number of Student's t distribution with an integer number of degrees of freedom lies within `t`
/// of zero (Abramowitz & Stegun, Handbook of Mathematical Functions, 26.7.3 and 26.7.4).
pub(super) fn probability_within(t: f64, freedom: usize) -> f64 {
    let angle = (t / (freedom as f64).sqrt()).atan();
    let (sin, cos) = angle.sin_cos();
    let is_odd = freedom % 2 == 1;
    let (mut term, mut sum) = if is_odd { (cos, 0.0) } else { (1.0, 0.0) };
    // Powers of the cosine below the number of degrees of freedom minus one.
    for n in 0..if is_odd { (freedom - 1) / 2 } else { freedom / 2 } {
        sum += term;
        let k = 2.0 * n as f64;
        term *= cos * cos * if is_odd { (k + 2.0) / (k + 3.0) } else { (k + 1.0) / (k + 2.0) };
    }
    if is_odd { std::f64::consts::FRAC_2_PI * (angle + sin * sum) } else { sin * sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles from tables: 90% and 95% for several degrees of freedom.
    #[test]
    fn quantiles_are_those_of_tables() {
        let known = [
            (1, 6.313_752, 0.9),
            (2, 2.919_986, 0.9),
            (3, 3.182_446, 0.95),
            (9, 2.262_157, 0.95),
            (10, 2.228_139, 0.95),
        ];
        for (freedom, t, expected) in known {
            let found = probability_within(t, freedom);
            assert!((found - expected).abs() < 1e-6, "{freedom}: {found}");
        }
    }
}
