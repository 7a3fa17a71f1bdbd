//! Polynomials through values of the past.

/// Lagrange's weight at `time` of the value at `times[k]`, of values at all `times`.
pub fn weight(times: &[f64], k: usize, time: f64) -> f64 {
    let others = times.iter().enumerate().filter(|(j, _)| *j != k);
    others.map(|(_, other)| (time - other) / (times[k] - other)).product()
}

/// Weights of the integral from 0 to `end` of the polynomial through values at `times`, at most four of them: by
/// Gauss's rule of two points, which is exact for cubics. For equal steps back from 0 they are those of Adams and
/// Bashforth.
pub fn integral(times: &[f64], end: f64) -> Vec<f64> {
    let middle = 0.5 * end;
    let points = [-1.0, 1.0].map(|sign| middle * (1.0 + sign / 3.0_f64.sqrt()));
    (0..times.len()).map(|k| middle * points.iter().map(|&point| weight(times, k, point)).sum::<f64>()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_steps_are_those_of_adams_and_bashforth() {
        let weights = integral(&[0.0, -0.1, -0.2, -0.3], 0.1);
        for (found, numerator) in weights.iter().zip([55.0, -59.0, 37.0, -9.0]) {
            assert!((found - numerator / 24.0 * 0.1).abs() < 1e-15);
        }
    }

    #[test]
    fn a_parabola_is_integrated_exactly_over_unequal_steps() {
        let times = [0.0, -0.3, -0.37];
        let sum: f64 = integral(&times, 0.2).iter().zip(times).map(|(w, t)| w * (1.0 + t * (2.0 - 3.0 * t))).sum();
        assert!((sum - (0.2 + 0.04 - 0.008)).abs() < 1e-15);
    }
}
