//! Chebyshev collocation on [0, 1]: points, integrals from 0, and interpolation.

use std::f64::consts::PI;

/// `intervals + 1` Chebyshev-Lobatto points and the matrix of the integrals from 0 to each of them, exact for the
/// polynomial through the values at the points.
#[derive(Debug)]
pub struct Collocation {
    pub points: Vec<f64>,
    integrals: Vec<f64>,
}

impl Collocation {
    pub fn new(intervals: usize) -> Self {
        let n = intervals;
        let angle = |k: usize, j: usize| (PI * ((k * j) % (2 * n)) as f64 / n as f64).cos();
        let points: Vec<f64> = (0..=n).map(|j| 0.5 * (1.0 - angle(1, j))).collect();
        // T_k at the point j, which is -cos(pi j / n) on [-1, 1], and its integral from -1.
        let polynomial = |k: usize, j: usize| if k.is_multiple_of(2) { angle(k, j) } else { -angle(k, j) };
        let primitive = |k: usize, j: usize| {
            let (up, m) = (polynomial(k + 1, j), k as f64);
            match k {
                0 => up,
                1 => 0.25 * polynomial(2, j),
                _ => 0.5 * (up / (m + 1.0) - polynomial(k - 1, j) / (m - 1.0)),
            }
        };
        let half_at_ends = |k: usize| if k == 0 || k == n { 0.5 } else { 1.0 };
        let mut integrals = vec![0.0; (n + 1) * (n + 1)];
        for j in 0..=n {
            let from_start: Vec<f64> = (0..=n).map(|k| half_at_ends(k) * (primitive(k, j) - primitive(k, 0))).collect();
            for i in 0..=n {
                let sum: f64 = (0..=n).map(|k| from_start[k] * polynomial(k, i)).sum();
                integrals[j * (n + 1) + i] = sum * half_at_ends(i) / n as f64;
            }
        }
        Self { points, integrals }
    }

    pub fn intervals(&self) -> usize {
        self.points.len() - 1
    }

    /// Weights of the integral from 0 to a point.
    pub fn up_to(&self, point: usize) -> &[f64] {
        let width = self.points.len();
        &self.integrals[point * width..(point + 1) * width]
    }

    /// Value at `x` of the polynomial through the values at the points (barycentric formula).
    pub fn interpolate(&self, values: impl Fn(usize) -> f64, x: f64) -> f64 {
        let (mut above, mut below) = (0.0, 0.0);
        for (j, &p) in self.points.iter().enumerate() {
            if (x - p).abs() < f64::EPSILON * 0.01 {
                return values(j);
            }
            let end = if j == 0 || j == self.intervals() { 0.5 } else { 1.0 };
            let weight = end * if j % 2 == 0 { 1.0 } else { -1.0 } / (x - p);
            above += weight * values(j);
            below += weight;
        }
        above / below
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_and_values_of_a_smooth_function_are_exact() {
        let grid = Collocation::new(24);
        let f: Vec<f64> = grid.points.iter().map(|x| (2.0 * x).exp()).collect();
        for (j, &x) in grid.points.iter().enumerate() {
            let sum: f64 = grid.up_to(j).iter().zip(&f).map(|(w, f)| w * f).sum();
            assert!((sum - 0.5 * ((2.0 * x).exp() - 1.0)).abs() < 1e-14);
        }
        assert!((grid.interpolate(|j| f[j], 0.3217) - 0.6434_f64.exp()).abs() < 1e-14);
        assert!((grid.interpolate(|j| f[j], grid.points[7]) - f[7]).abs() < 1e-15);
        // A function that vanishes at the wall keeps its digits close to it: round-off times the number of points.
        assert!((grid.interpolate(|j| grid.points[j], 1e-15) - 1e-15).abs() < 1e-27);
    }
}
