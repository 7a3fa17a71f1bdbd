//! Polynomial extrapolation, fits and integration of past values.

/// Lagrange weight at `time` of the value at `times[k]`, for interpolation of values at all `times`.
pub fn weight(times: &[f64], k: usize, time: f64) -> f64 {
    let others = times.iter().enumerate().filter(|(j, _)| *j != k);
    others.map(|(_, other)| (time - other) / (times[k] - other)).product()
}

/// Weights of the values at `times` in the value at `time` of the least-squares polynomial of a degree.
pub fn fitted(times: &[f64], degree: usize, time: f64) -> Vec<f64> {
    // Orthogonal polynomials on the times, by Stieltjes' recurrence.
    let n = times.len();
    let (mut last, mut now) = (vec![0.0; n], vec![1.0; n]);
    let (mut last_at, mut now_at) = (0.0, 1.0);
    let mut weights = vec![0.0; n];
    let mut last_norm = 1.0;
    for k in 0..=degree.min(n - 1) {
        let norm: f64 = now.iter().map(|p| p * p).sum();
        weights.iter_mut().zip(&now).for_each(|(w, p)| *w += now_at * p / norm);
        let mean = times.iter().zip(&now).map(|(t, p)| t * p * p).sum::<f64>() / norm;
        let back = if k == 0 { 0.0 } else { norm / last_norm };
        let next: Vec<f64> = (0..n).map(|i| (times[i] - mean) * now[i] - back * last[i]).collect();
        let next_at = (time - mean) * now_at - back * last_at;
        (last, now) = (now, next);
        (last_at, now_at) = (now_at, next_at);
        last_norm = norm;
    }
    weights
}

/// Weights of the integral from 0 to `end` of the polynomial through values at up to four `times`, by the two-point
/// Gauss rule, which is exact for cubics. For equal steps back from 0 they are the weights of Adams and Bashforth.
pub fn integral(times: &[f64], end: f64) -> Vec<f64> {
    let middle = 0.5 * end;
    let points = [-1.0, 1.0].map(|sign| middle * (1.0 + sign / 3.0_f64.sqrt()));
    (0..times.len()).map(|k| middle * points.iter().map(|&point| weight(times, k, point)).sum::<f64>()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_values_as_powers_are_met_exactly() {
        let times = [0.0, -0.3, -0.37];
        let fitted = fitted(&times, 2, 0.2);
        for (k, found) in fitted.into_iter().enumerate() {
            assert!((found - weight(&times, k, 0.2)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_line_through_three_values_is_that_of_least_squares() {
        let found = fitted(&[0.0, -1.0, -2.0], 1, 1.0);
        for (found, expected) in found.into_iter().zip([4.0 / 3.0, 1.0 / 3.0, -2.0 / 3.0]) {
            assert!((found - expected).abs() < 1e-15);
        }
        assert_eq!(fitted(&[0.0], 1, 1.0), [1.0]);
    }

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
