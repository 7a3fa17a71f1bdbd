//! Resolution, stencil and cutoff that keep a tolerance.
//!
//! The error of an evaluation comes from the grid spacing `h`, from the truncation of the stencils and, with the
//! split method, from the cutoff `r_c` of the pairs. Each part depends on one number in units of the Gaussian's width
//! `Sigma`. The bounds below are upper envelopes of errors measured one at a time against sums over wavevectors
//! (`cargo run --release -p fcm --example errors`), for ratios of radii from 1 to 4 and volume fractions up to 40%.
//! The parts are independent, so their squares add up.

use crate::grid::window::KaiserBessel;
use crate::plan::problem::Multipoles;
use std::f64::consts::PI;
use std::ops::{Range, RangeInclusive};

/// Tolerance of an evaluation, or four times that of an iteration, below which the grid needs `f64`.
pub(crate) const FINEST_SINGLE: f64 = 1e-6;

/// Upper bound of the round-off error of a grid in `f32`, relative to the motions, for ten to twenty thousand
/// spheres.
pub(crate) const ROUND_OFF: f64 = 4e-7;

/// Shares of the tolerance for grid and stencils together, and for the cutoff: `0.89^2 + 0.45^2 < 1`.
const GRID_SHARE: f64 = 0.89;
const CUTOFF_SHARE: f64 = 0.45;

/// Resolution of the grid and length of the stencils, in units of the Gaussian's width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Accuracy {
    /// Gaussian width over grid spacing.
    pub resolution: f64,
    /// Points of a stencil along an axis.
    pub points: usize,
}

/// Coefficients of the brackets `(1 + k^2 D/2) (1 + k^2 rest)` that correct the common Gaussian of the split method,
/// over the square of its width: see `Common` in `envelope.rs`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Brackets {
    /// `D/2`, half the common difference of the squared widths.
    pub common: f64,
    /// Typical `|d - D| / 2`.
    pub own: f64,
    /// Factor by which wavevectors are longer along an axis of the box than along the lattice: `sqrt(1 + s^2)` in a
    /// box sheared by `s`, for example.
    pub stretch: f64,
    /// Largest radius over the width. Errors of moments are relative to a sphere's own field, `m / (4 pi a^3)`, and to
    /// that over its radius, and the fields of common Gaussians are in proportion to `m / Sigma^3`.
    pub size: f64,
}

impl Brackets {
    /// Factor of the errors of moments: those of gradients are in proportion to `size^4`, those of fields to `size^3`.
    fn of_moments(self) -> f64 {
        self.size.powi(3) * self.size.max(0.4)
    }

    /// Product of the brackets at a wavenumber in units of the inverse width.
    fn at(self, wavenumber: f64) -> f64 {
        let square = wavenumber * wavenumber;
        (1.0 + self.common * square) * (1.0 + self.own * square)
    }
}

/// Truncation error of the direct method's grid with `Sigma / h = resolution`: the part of a squared Gaussian beyond
/// the highest wavenumber, `pi / h`. With forces alone no derivatives are involved.
pub fn direct_grid_error(terms: Multipoles, resolution: f64) -> f64 {
    let decay = (-(PI * resolution).powi(2)).exp();
    match terms {
        Multipoles::Dipole | Multipoles::Moments => 8.5 * decay,
        Multipoles::Monopole => 0.28 / (resolution * resolution) * decay,
    }
}

/// Truncation error of the split method's grid, with the brackets that restore the far field.
pub fn split_grid_error(terms: Multipoles, resolution: f64, brackets: Brackets) -> f64 {
    let decay = (-(PI * resolution).powi(2)).exp() * brackets.at(PI * resolution).powi(2);
    match terms {
        Multipoles::Dipole => 1.3 * decay,
        Multipoles::Moments => 1.1 * brackets.of_moments() * decay,
        Multipoles::Monopole => 0.1 / (resolution * resolution) * decay,
    }
}

/// Error of the direct method's stencils if they end `reach` widths from the particle, where a Gaussian has fallen to
/// `exp(-reach^2 / 2)`.
pub fn stencil_error(reach: f64) -> f64 {
    2.0 * (-0.5 * reach * reach).exp()
}

/// Aliasing error of a window of `points` points. Wavenumbers from `2 pi / h` on, and farther in a sheared box, alias
/// onto those of the Gaussian. Derivatives on the grid amplify the error: one for each side of a dipole, and two for
/// `1 - rest lap`; for a moment one, and two for the gradient of its field.
pub fn window_error(terms: Multipoles, points: usize, resolution: f64, brackets: Brackets) -> f64 {
    let window = KaiserBessel::new(points, resolution).shape();
    let folded = (resolution * brackets.stretch).powi(2);
    let rest = brackets.own * 4.0 * PI * PI * folded;
    match terms {
        Multipoles::Dipole => 165.0 * folded * (1.0 + rest) * (-0.92 * window).exp(),
        Multipoles::Moments => 130.0 * brackets.of_moments() * folded * (-0.92 * window).exp(),
        Multipoles::Monopole => {
            // Up to about the highest wavenumber that matters.
            let common = 1.0 + brackets.common * (0.5 * points as f64 / resolution).powi(2);
            28.0 * (1.0 + 4.0 * rest) * common * (-window).exp()
        }
    }
}

/// Error of leaving out pairs farther apart than `cutoff` widths. With forces alone it vanishes if the common
/// Gaussian is the envelope of every particle.
pub fn cutoff_error(terms: Multipoles, cutoff: f64, brackets: Brackets) -> f64 {
    let square = 0.25 * cutoff * cutoff;
    let beyond = |distance: f64| (cutoff - distance).max(0.0).powi(2);
    let size = match terms {
        Multipoles::Moments => brackets.of_moments() * (0.5 + 0.15 * cutoff),
        Multipoles::Dipole => (0.75 + 2.0 * beyond(5.8)) * (1.0 + brackets.own * square).powf(1.5),
        Multipoles::Monopole => {
            let other = (2.0 * (brackets.common + brackets.own)).min(1.0);
            (0.15 + 0.4 * beyond(5.0)) * (other * (2.0 - other)).powi(2)
        }
    };
    size * (-square).exp()
}

/// Smallest cutoff that keeps a tolerance, in widths.
pub(crate) fn cutoff(terms: Multipoles, tolerance: f64, brackets: Brackets) -> f64 {
    let enough = |&cutoff: &f64| cutoff_error(terms, cutoff, brackets) <= CUTOFF_SHARE * tolerance;
    (100..2000).map(|c| f64::from(c) * 0.01).find(enough).expect("an error that decays gets small")
}

/// Error of the direct method's grid and stencils; `resolution` is in units of the narrowest Gaussian and `reach` in
/// units of the widest.
pub(crate) fn direct_error(terms: Multipoles, resolution: f64, reach: f64) -> f64 {
    direct_grid_error(terms, resolution).hypot(stencil_error(reach))
}

/// Error of the split method's grid and window.
pub(crate) fn split_error(terms: Multipoles, resolution: f64, points: usize, brackets: Brackets) -> f64 {
    split_grid_error(terms, resolution, brackets).hypot(window_error(terms, points, resolution, brackets))
}

impl Accuracy {
    /// Choices of the direct method that keep a tolerance: from the shortest stencil, which needs a fine grid, to a
    /// few points more. With forces alone grids are coarse, and the error of the shortest stencils exceeds the bound
    /// from their truncation.
    pub fn direct(terms: Multipoles, tolerance: f64) -> Vec<Self> {
        // With a fixed number of points a finer grid loses more by truncation of the stencil than it gains in
        // resolution.
        let error = |points: usize, resolution: f64| direct_error(terms, resolution, 0.5 * points as f64 / resolution);
        let is_enough = |points, hundredths| error(points, resolution(hundredths)) <= GRID_SHARE * tolerance;
        let fewest = if terms == Multipoles::Monopole { 5 } else { 3 };
        options(fewest..=100, |points| RESOLUTIONS.clone().find(|&r| is_enough(points, r)))
    }

    /// Choices of the split method that keep a tolerance; `brackets` gives the brackets at a resolution.
    pub fn split(terms: Multipoles, tolerance: f64, brackets: impl Fn(f64) -> Brackets) -> Vec<Self> {
        let fewest = if terms == Multipoles::Monopole { 4 } else { 3 };
        let error = |points: usize, resolution: f64| split_error(terms, resolution, points, brackets(resolution));
        let is_enough = |points, hundredths| error(points, resolution(hundredths)) <= GRID_SHARE * tolerance;
        options(fewest..=KaiserBessel::POINTS[1], |points| {
            // Errors fall with the resolution, so a bisection finds the coarsest.
            let Range { start: mut coarse, end: mut fine } = RESOLUTIONS;
            while coarse < fine {
                let middle = u32::midpoint(coarse, fine);
                if is_enough(points, middle) { fine = middle } else { coarse = middle + 1 }
            }
            (fine < RESOLUTIONS.end).then_some(fine)
        })
    }
}

/// Resolutions to choose from, in hundredths.
const RESOLUTIONS: Range<u32> = 50..400;

fn resolution(hundredths: u32) -> f64 {
    f64::from(hundredths) * 0.01
}

/// The coarsest grid for each number of points, for the five shortest stencils that have one.
fn options(points: RangeInclusive<usize>, coarsest: impl Fn(usize) -> Option<u32>) -> Vec<Accuracy> {
    let option = |points| Some(Accuracy { resolution: resolution(coarsest(points)?), points });
    points.filter_map(option).take(5).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_trade_points_for_spacing() {
        for digits in 1..=12 {
            let tolerance = 0.2 * 10f64.powi(-digits);
            let brackets = Brackets { common: 0.3, own: 0.1, stretch: 1.0, size: 0.7 };
            for terms in [Multipoles::Dipole, Multipoles::Monopole, Multipoles::Moments] {
                for options in [Accuracy::direct(terms, tolerance), Accuracy::split(terms, tolerance, |_| brackets)] {
                    assert!(!options.is_empty());
                    assert!(options.windows(2).all(|o| o[0].resolution >= o[1].resolution));
                }
                let limit = GRID_SHARE * tolerance;
                for Accuracy { resolution, points } in Accuracy::direct(terms, tolerance) {
                    let error = |resolution: f64| direct_error(terms, resolution, 0.5 * points as f64 / resolution);
                    assert!(error(resolution) <= limit && error(resolution - 0.01) > limit, "{points} at {resolution}");
                }
                for Accuracy { resolution, points } in Accuracy::split(terms, tolerance, |_| brackets) {
                    assert!(split_error(terms, resolution - 0.01, points, brackets) > limit);
                    let left_out = cutoff_error(terms, cutoff(terms, tolerance, brackets), brackets);
                    assert!(split_error(terms, resolution, points, brackets).hypot(left_out) <= tolerance);
                }
            }
        }
    }
}
