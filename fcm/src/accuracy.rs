//! What a tolerance needs.
//!
//! The error of an evaluation comes from the grid's spacing `h`, the stencils' ends and, with the split method, the
//! pairs' cutoff `r_c`; each part depends on one number in units of the Gaussian's width `Sigma`. The bounds below are
//! the upper edges of errors measured one at a time against sums over wavevectors
//! (`cargo run --release -p fcm --example errors`), for radii of ratios 1 to 4 and volume fractions to 40%. The parts
//! know nothing of each other, so that their squares add up.

use crate::problem::MethodName;
use crate::window::Window;
use std::f64::consts::PI;
use std::ops::{Range, RangeInclusive};

/// Tolerances below this need a grid in `f64`.
pub(crate) const FINEST_SINGLE: f64 = 2e-5;

/// Shares of a tolerance for the grid and the stencils together, and for the cutoff: `0.89^2 + 0.45^2 < 1`.
const GRID_SHARE: f64 = 0.89;
const CUTOFF_SHARE: f64 = 0.45;

/// A grid and stencils, in units of the Gaussian's width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Accuracy {
    /// Width over grid spacing.
    pub resolution: f64,
    /// Points of a stencil.
    pub points: usize,
}

/// Error of a grid with `Sigma / h = resolution`: what a Gaussian squared has beyond the highest wavevector, `pi / h`,
/// and for the split method the polynomials that restore the far field.
pub(crate) fn grid_error(method: MethodName, resolution: f64) -> f64 {
    let decay = (-(PI * resolution).powi(2)).exp();
    match method {
        MethodName::Direct => 8.5 * decay,
        MethodName::Split => 30.0 * resolution * resolution * decay,
    }
}

/// Error of the direct method's stencils that end `reach` widths from the particle, where a Gaussian has fallen to
/// `exp(-reach^2 / 2)`.
pub(crate) fn stencil_error(reach: f64) -> f64 {
    2.0 * (-0.5 * reach * reach).exp()
}

/// Error of a window of so many points by what folds onto the wavenumbers of the Gaussian, times what derivatives make
/// of it: see [`roughness`].
pub(crate) fn window_error(points: usize, resolution: f64, roughness: f64) -> f64 {
    165.0 * resolution * resolution * roughness * (-0.92 * Window::new(points, resolution).shape()).exp()
}

/// What the second derivatives on the grid, `1 - rest lap`, make of a window's error: what folds comes from wavenumbers
/// about `2 pi / h` and beyond.
pub(crate) fn roughness(rest: f64, spacing: f64) -> f64 {
    1.0 + rest * (2.0 * PI / spacing).powi(2)
}

/// Error of leaving out pairs farther apart than `cutoff` widths, with derivatives `1 - rest lap`, `rest` over the
/// square of the width.
pub(crate) fn cutoff_error(cutoff: f64, rest: f64) -> f64 {
    let square = 0.25 * cutoff * cutoff;
    (0.75 + 2.0 * (cutoff - 5.8).max(0.0).powi(2)) * (1.0 + rest * square).powf(1.5) * (-square).exp()
}

/// The cutoff that keeps a tolerance, in widths.
pub(crate) fn cutoff(tolerance: f64, rest: f64) -> f64 {
    let enough = |&cutoff: &f64| cutoff_error(cutoff, rest) <= CUTOFF_SHARE * tolerance;
    (100..2000).map(|c| f64::from(c) * 0.01).find(enough).expect("an error that decays gets small")
}

/// Error of the direct method's grid and stencils, in units of the narrowest and of the widest Gaussian.
pub(crate) fn direct_error(resolution: f64, reach: f64) -> f64 {
    grid_error(MethodName::Direct, resolution).hypot(stencil_error(reach))
}

/// Error of the split method's grid and window.
pub(crate) fn split_error(resolution: f64, points: usize, roughness: f64) -> f64 {
    grid_error(MethodName::Split, resolution).hypot(window_error(points, resolution, roughness))
}

impl Accuracy {
    /// Ways of the direct method to keep a tolerance, from the shortest stencil, which needs a fine grid, to a few
    /// points more.
    pub fn direct(tolerance: f64) -> Vec<Self> {
        // A finer grid takes more from a stencil of so many points than it gives.
        let error = |points: usize, resolution: f64| direct_error(resolution, 0.5 * points as f64 / resolution);
        let is_enough = |points, hundredths| error(points, resolution(hundredths)) <= GRID_SHARE * tolerance;
        options(3..=100, |points| RESOLUTIONS.clone().find(|&r| is_enough(points, r)))
    }

    /// The same of the split method, with the roughness that a resolution has.
    pub fn split(tolerance: f64, roughness: impl Fn(f64) -> f64) -> Vec<Self> {
        let error = |points: usize, resolution: f64| split_error(resolution, points, roughness(resolution));
        let is_enough = |points, hundredths| error(points, resolution(hundredths)) <= GRID_SHARE * tolerance;
        options(3..=Window::POINTS[1], |points| {
            // Errors fall with the resolution: it is halved in on.
            let Range { start: mut coarse, end: mut fine } = RESOLUTIONS;
            while coarse < fine {
                let middle = u32::midpoint(coarse, fine);
                if is_enough(points, middle) { fine = middle } else { coarse = middle + 1 }
            }
            (fine < RESOLUTIONS.end).then_some(fine)
        })
    }
}

/// Resolutions that are tried, in hundredths.
const RESOLUTIONS: Range<u32> = 50..400;

fn resolution(hundredths: u32) -> f64 {
    f64::from(hundredths) * 0.01
}

/// The coarsest grid for each stencil, from the shortest that has one on.
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
            for options in [Accuracy::direct(tolerance), Accuracy::split(tolerance, |_| 1.0)] {
                assert!(!options.is_empty());
                assert!(options.windows(2).all(|o| o[0].resolution >= o[1].resolution));
            }
            let limit = GRID_SHARE * tolerance;
            for Accuracy { resolution, points } in Accuracy::direct(tolerance) {
                let error = |resolution: f64| direct_error(resolution, 0.5 * points as f64 / resolution);
                assert!(error(resolution) <= limit && error(resolution - 0.01) > limit, "{points} at {resolution}");
            }
            for option in Accuracy::split(tolerance, |_| 2.0) {
                assert!(split_error(option.resolution - 0.01, option.points, 2.0) > limit);
                let left_out = cutoff_error(cutoff(tolerance, 0.1), 0.1);
                assert!(split_error(option.resolution, option.points, 2.0).hypot(left_out) <= tolerance);
            }
        }
    }
}
