//! What a tolerance needs.
//!
//! The error of an evaluation comes from the grid's spacing `h`, the stencils' ends and, with the split method, the
//! pairs' cutoff `r_c`; each part depends on one number in units of the Gaussian's width `Sigma`. The bounds below are
//! the upper edges of errors measured one at a time against sums over wavevectors
//! (`cargo run --release -p fcm --example errors`), for radii of ratios 1 to 4 and volume fractions to 40%. The parts
//! know nothing of each other, so that their squares add up.

use crate::problem::MethodName;
use std::f64::consts::PI;

/// Tolerances below this need a grid in `f64`.
pub(crate) const FINEST_SINGLE: f64 = 2e-5;

/// Shares of a tolerance for the grid and the stencils together, and for the cutoff: `0.89^2 + 0.45^2 < 1`.
const GRID_SHARE: f64 = 0.89;
const CUTOFF_SHARE: f64 = 0.45;

/// Error expected of a grid, stencils and, with the split method, a cutoff, in units of the Gaussian's width.
pub(crate) fn expected(method: MethodName, resolution: f64, reach: f64, cutoff: f64) -> f64 {
    let left_out = if method == MethodName::Split { cutoff_error(cutoff) } else { 0.0 };
    error_by_grid(method, resolution, reach).hypot(left_out)
}

/// The part of it by the grid and the stencils.
fn error_by_grid(method: MethodName, resolution: f64, reach: f64) -> f64 {
    grid_error(method, resolution).hypot(stencil_error(method, reach))
}

/// A grid and cutoffs that keep a tolerance, in units of the Gaussian's width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Accuracy {
    /// Width over grid spacing.
    pub resolution: f64,
    /// Half a stencil over the width.
    pub reach: f64,
    /// Cutoff of the pairs over the width.
    pub cutoff: f64,
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

/// Error of stencils that end `reach` widths from the particle: there a Gaussian has fallen to `exp(-reach^2 / 2)`, and
/// the split method's polynomial has grown.
pub(crate) fn stencil_error(method: MethodName, reach: f64) -> f64 {
    let decay = (-0.5 * reach * reach).exp();
    match method {
        MethodName::Direct => 2.0 * decay,
        // The bound falls with the reach, also where that is too short to be of use.
        MethodName::Split => 0.03 * reach.max(2.5).powf(4.5) * decay,
    }
}

/// Error of leaving out pairs farther apart than `cutoff` widths.
pub(crate) fn cutoff_error(cutoff: f64) -> f64 {
    (0.75 + 2.0 * (cutoff - 5.8).max(0.0).powi(2)) * (-0.25 * cutoff * cutoff).exp()
}

impl Accuracy {
    /// Ways to keep a tolerance, from the shortest stencil, which needs a fine grid, to a few points more.
    pub fn options(method: MethodName, tolerance: f64) -> Vec<Self> {
        let cutoff = match method {
            MethodName::Direct => 0.0,
            MethodName::Split => smallest(|c| cutoff_error(c) <= CUTOFF_SHARE * tolerance),
        };
        let limit = GRID_SHARE * tolerance;
        let error = |resolution: f64, points: f64| error_by_grid(method, resolution, 0.5 * points / resolution);
        let mut options = Vec::new();
        for points in 3..100 {
            let points = f64::from(points);
            let coarsest = (50..400).map(|r| f64::from(r) * 0.01).find(|&r| error(r, points) <= limit);
            if let Some(resolution) = coarsest {
                options.push(Self { resolution, reach: 0.5 * points / resolution, cutoff });
            }
            if options.len() == 5 {
                break;
            }
        }
        options
    }
}

fn smallest(holds: impl Fn(f64) -> bool) -> f64 {
    (100..2000).map(|c| f64::from(c) * 0.01).find(|&c| holds(c)).expect("an error that decays gets small")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_trade_points_for_spacing() {
        for method in [MethodName::Direct, MethodName::Split] {
            for digits in 1..=12 {
                let options = Accuracy::options(method, 10f64.powi(-digits));
                assert_eq!(options.len(), 5);
                assert!(options.windows(2).all(|o| o[0].resolution >= o[1].resolution));
                let error = |o: &Accuracy| expected(method, o.resolution, o.reach, o.cutoff);
                assert!(options.iter().all(|o| error(o) <= 10f64.powi(-digits)));
            }
        }
    }
}
