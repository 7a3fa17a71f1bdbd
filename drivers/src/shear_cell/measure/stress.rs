//! Mean stress on a wall and its error.

use super::super::{Model, Side};
use domain::Vector;

/// A mean with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Its standard error, correlations included. Not a number from fewer than two values.
    pub error: f64,
}

/// Stress on a wall, averaged over windows of time (eq. 24).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallStress {
    /// Which wall.
    pub side: Side,
    /// Normal stress: pressure is positive.
    pub normal: Estimate,
    /// Shear stress along the flow, positive where the grains drag the wall forward.
    pub along: Estimate,
    /// Shear stress across the flow: along z on bottom and top, along y on the sides.
    pub across: Estimate,
    /// Standard deviation of the normal stress over the windows.
    pub deviation: f64,
}

/// Fewest blocks from which an error is estimated.
const BLOCKS: usize = 16;

/// The mean of a series and its standard error by blocking (Flyvbjerg and Petersen 1989): neighbours are averaged
/// again and again, which leaves the mean and uncovers correlations; the largest error met with at least 16 blocks left
/// is taken.
pub fn estimate(series: &[f64]) -> Estimate {
    let mean = |s: &[f64]| s.iter().sum::<f64>() / s.len() as f64;
    let error = |s: &[f64]| {
        let (n, m) = (s.len() as f64, mean(s));
        (s.iter().map(|x| (x - m).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt()
    };
    let mut blocks = series.to_vec();
    let mut largest = error(&blocks);
    while blocks.len() >= 2 * BLOCKS {
        blocks = blocks.chunks_exact(2).map(mean).collect();
        largest = largest.max(error(&blocks));
    }
    Estimate { mean: mean(series), error: largest }
}

impl WallStress {
    /// From the impulses that a wall took in windows of equal length.
    pub(in super::super) fn new(model: &Model, side: Side, impulses: &[Vector], window: f64) -> Self {
        let normal = model.face(side, 0.0).normal();
        let across = if side.axis() == 1 { Vector::Z } else { Vector::Y };
        let series = |direction: Vector| -> Vec<f64> {
            impulses.iter().map(|p| p.dot(direction) / (model.area(side) * window)).collect()
        };
        let pressure = series(-normal);
        let mean = estimate(&pressure);
        let spread = pressure.iter().map(|p| (p - mean.mean).powi(2)).sum::<f64>() / pressure.len() as f64;
        Self {
            side,
            normal: mean,
            along: estimate(&series(Vector::X)),
            across: estimate(&series(across)),
            deviation: spread.sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Random;

    /// An autoregressive series x' = r x + noise has the variance of its mean enlarged by (1 + r)/(1 - r).
    #[test]
    fn blocking_finds_the_error_of_a_correlated_series() {
        let (r, count) = (0.9, 1 << 16);
        let mut random = Random::new(5, 0);
        let mut x = 0.0;
        let series: Vec<f64> = (0..count)
            .map(|_| {
                x = r * x + random.uniform() - 0.5;
                x + 3.0
            })
            .collect();
        let variance = 1.0 / 12.0 / (1.0 - r * r);
        let expected = (variance * (1.0 + r) / (1.0 - r) / f64::from(count)).sqrt();
        let found = estimate(&series);
        assert!((found.mean - 3.0).abs() < 5.0 * expected);
        // The error of an error from 16 blocks is a fifth; the largest of several is taken.
        assert!(found.error > 0.9 * expected && found.error < 1.7 * expected, "{} {expected}", found.error);
    }
}
