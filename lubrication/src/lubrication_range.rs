//! Range of gaps in which lubrication acts.

use thiserror::Error;

use crate::factor_table::{CLOSEST, FARTHEST};
use crate::wall_table;

/// Range of gaps of the lubrication correction: its cutoff over the larger radius of a pair, with which the errors of
/// the far field scale, and the gap below which the correction is constant, over the mean radius.
///
/// At gaps above `TAPER * cutoff` the correction is multiplied by a factor that falls to zero at the cutoff with two
/// continuous derivatives. Below the gap `minimum_gap` the correction is constant, also for spheres that overlap unless
/// they are to separate again, see [`Self::separating`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LubricationRange {
    cutoff: f64,
    minimum_gap: f64,
    separates_overlaps: bool,
}

/// An invalid range.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum RangeError {
    /// The cutoff is outside of the tables.
    #[error(
        "lubrication cutoff is {0}; it is a gap over the larger radius: give a number above 0.001, at most 8 (2.5 is \
         accurate, 0.2 is customary)"
    )]
    Cutoff(f64),
    /// The smallest gap is outside of the tables, or too large for the cutoff.
    #[error(
        "closest gap of lubrication is {0}; it is a gap over the mean radius: give a number from 1e-6 to a tenth of \
         the cutoff"
    )]
    MinimumGap(f64),
}

impl LubricationRange {
    /// Cutoff with which two spheres move within 1% of the exact solution at every gap, for radii up to 2:1.
    pub const WIDE: f64 = 2.5;
    /// Cutoff of Dance & Maxey (2003) and Yeo & Maxey (2010); the correction is still large there.
    pub const NARROW: f64 = 0.2;
    /// Default of the gap below which lubrication is constant.
    pub const MINIMUM_GAP: f64 = 1e-6;
    /// Fraction of the cutoff up to which the correction is not tapered.
    pub const TAPER: f64 = 0.75;

    /// Lubrication at gaps up to `cutoff`, constant below the gap `minimum_gap`.
    pub fn new(cutoff: f64, minimum_gap: f64) -> Result<Self, RangeError> {
        if !(cutoff > 1e-3 && cutoff <= FARTHEST) {
            return Err(RangeError::Cutoff(cutoff));
        }
        if !(minimum_gap >= 10.0 * CLOSEST && minimum_gap <= 0.1 * cutoff) {
            return Err(RangeError::MinimumGap(minimum_gap));
        }
        Ok(Self { cutoff, minimum_gap, separates_overlaps: false })
    }

    /// Gap at which the correction ends, over the larger radius.
    pub fn cutoff(&self) -> f64 {
        self.cutoff
    }

    /// Gap below which the correction is constant, over the mean radius.
    pub fn minimum_gap(&self) -> f64 {
        self.minimum_gap
    }

    /// The same for spheres that Brownian displacements bring into overlap: overlapping spheres are lubricated as at
    /// a gap equal to the overlap. At the closest gap they would separate a million times more slowly under forces,
    /// and hardly at all by Brownian motion.
    #[must_use]
    pub fn separating(self) -> Self {
        Self { separates_overlaps: true, ..self }
    }

    /// Whether overlapping spheres are lubricated as at a gap equal to the overlap.
    pub fn separates_overlaps(&self) -> bool {
        self.separates_overlaps
    }

    /// Gap at which the correction of a pair is evaluated, bounded below by `minimum_gap`.
    #[inline(always)]
    pub(crate) fn effective_gap(&self, gap: f64, minimum_gap: f64) -> f64 {
        let gap = if self.separates_overlaps { gap.abs() } else { gap };
        gap.max(minimum_gap)
    }

    /// Range for a sphere and a wall, with gaps over its radius: the errors of the far field extend less far than
    /// between spheres.
    #[must_use]
    pub fn at_wall(self) -> Self {
        Self { cutoff: self.cutoff.min(wall_table::FARTHEST), ..self }
    }

    /// Taper of the factor `B` of the correction at a gap over the larger radius: the square root of a quintic step
    /// from 1 to 0.
    pub(crate) fn taper(&self, gap: f64) -> f64 {
        self.taper_factor(gap).sqrt()
    }

    /// Taper of the correction itself.
    #[inline(always)]
    pub(crate) fn taper_factor(&self, gap: f64) -> f64 {
        let x = ((1.0 - gap / self.cutoff) / (1.0 - Self::TAPER)).clamp(0.0, 1.0);
        x * x * x * (10.0 - x * (15.0 - 6.0 * x))
    }
}

impl Default for LubricationRange {
    fn default() -> Self {
        Self { cutoff: Self::WIDE, minimum_gap: Self::MINIMUM_GAP, separates_overlaps: false }
    }
}
