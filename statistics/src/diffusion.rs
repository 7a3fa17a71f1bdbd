//! Diffusivities from correlations and displacements.

use crate::{Estimate, Lag, LagSums};
use domain::Vector;

/// Diffusivity along each axis, in two ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Diffusivity {
    /// `D = integral_0^inf <v(0) v(t)> dt`, eq. (16): the mean of the integrals up to the lags of the window.
    pub by_integral: [Estimate; 3],
    /// `D = 1/2 d<d^2>/dt`, eq. (17): half the slope of the least-squares line through the mean square displacement
    /// in the window.
    pub by_slope: [Estimate; 3],
}

impl Diffusivity {
    /// Diffusivity of a species or of all particles, from the lags in a time window in which motion is diffusive. NaN
    /// if there are fewer than two such lags.
    pub fn of(sums: &LagSums, species: Option<usize>, window: [f64; 2]) -> Self {
        let inside = |lag: &&Lag| (window[0]..=window[1]).contains(&lag.time);
        let integral = |lags: &[Lag], i: usize| {
            let values: Vec<f64> = lags.iter().filter(inside).map(|lag| lag.correlation_integral[i]).collect();
            values.iter().sum::<f64>() / values.len() as f64
        };
        let slope = |lags: &[Lag], i: usize| {
            0.5 * slope(
                &lags.iter().filter(inside).map(|lag| (lag.time, lag.mean_square_displacement[i])).collect::<Vec<_>>(),
            )
        };
        Self {
            by_integral: [0, 1, 2].map(|i| sums.estimate(species, |lags| integral(lags, i))),
            by_slope: [0, 1, 2].map(|i| sums.estimate(species, |lags| slope(lags, i))),
        }
    }
}

impl Diffusivity {
    /// Half the slope of the mean square displacement in a window of lags, the mean over the axes.
    pub fn mean_slope(lags: &[Lag], window: [f64; 2]) -> f64 {
        let inside = lags.iter().filter(|lag| (window[0]..=window[1]).contains(&lag.time));
        let mean = |lag: &Lag| lag.mean_square_displacement.dot(Vector::splat(1.0 / 3.0));
        0.5 * slope(&inside.map(|lag| (lag.time, mean(lag))).collect::<Vec<_>>())
    }
}

/// Slope of the least-squares line.
fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let (above, below) =
        points.iter().fold((0.0, 0.0), |(above, below), p| (above + (p.0 - x) * (p.1 - y), below + (p.0 - x).powi(2)));
    above / below
}

/// Mean radius `<a> = sum_i a_i phi_i / sum_i phi_i`, eq. (18), of species given by radius and volume fraction.
pub fn mean_radius(species: &[(f64, f64)]) -> f64 {
    let fractions: f64 = species.iter().map(|(_, phi)| phi).sum();
    species.iter().map(|(a, phi)| a * phi).sum::<f64>() / fractions
}

/// Global diffusion coefficient `D_g = D / (<a>^2 rate)`, eq. (18), with `D` the diffusivity of all particles
/// regardless of their size.
pub fn global_coefficient(diffusivity: f64, species: &[(f64, f64)], shear_rate: f64) -> f64 {
    diffusivity / (mean_radius(species).powi(2) * shear_rate.abs())
}

/// Mean diffusion coefficient of eq. (19),
///
/// ```text
/// <D> = D_g <a>^2 / (sum_i (phi_i / phi) D_i a_i^2),
/// ```
///
/// with the scale given by the coefficients `D_i`, over `a_i^2 rate`, of each species alone at the same total volume
/// fraction.
pub fn mean_coefficient(global: f64, species: &[(f64, f64)], alone: &[f64]) -> f64 {
    let fractions: f64 = species.iter().map(|(_, phi)| phi).sum();
    let scale: f64 = species.iter().zip(alone).map(|((a, phi), d)| phi / fractions * d * a * a).sum();
    global * mean_radius(species).powi(2) / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_of_one_species_are_its_own() {
        let one = [(2.0, 0.1)];
        assert!((mean_radius(&one) - 2.0).abs() < 1e-15);
        assert!((global_coefficient(0.6, &one, -3.0) - 0.05).abs() < 1e-15);
        assert!((mean_coefficient(0.05, &one, &[0.05]) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn two_species_are_weighted_by_volume() {
        let two = [(1.0, 0.05), (2.0, 0.05)];
        assert!((mean_radius(&two) - 1.5).abs() < 1e-15);
        // D_g <a>^2 / (1/2 D_1 + 1/2 4 D_2)
        assert!((mean_coefficient(0.1, &two, &[0.2, 0.05]) - 0.1 * 2.25 / 0.2).abs() < 1e-15);
    }
}
