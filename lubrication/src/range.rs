//! From which gap to which lubrication acts.

use thiserror::Error;

use crate::root_table::{CLOSEST, FARTHEST};
use crate::wall_table;

/// Gaps between which the lubrication correction acts: where it ends over the larger radius of a pair, which says how
/// far what the method misses reaches, and where it grows no more over the mean radius.
///
/// At gaps above `TAPER * cutoff` the correction is multiplied by a factor that falls to zero at the cutoff with two
/// continuous derivatives. At gaps below `closest` it stays what it is there, and so it does for spheres that overlap unless these
/// are to part again, see [`Self::parting`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    cutoff: f64,
    closest: f64,
    parts: bool,
}

/// A range that makes no sense.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum RangeError {
    /// The cutoff is outside the tables.
    #[error(
        "lubrication cutoff is {0}; it is a gap over the larger radius: give a number above 0.001, at most 8 (2.5 is accurate, 0.2 is customary)"
    )]
    Cutoff(f64),
    /// The smallest gap is outside the tables, or beyond the cutoff.
    #[error(
        "closest gap of lubrication is {0}; it is a gap over the mean radius: give a number from 1e-6 to a tenth of the cutoff"
    )]
    Closest(f64),
}

impl Range {
    /// Cutoff with which two spheres move within 1% of the exact solution at every gap, for radii up to 2:1.
    pub const WIDE: f64 = 2.5;
    /// Cutoff of Dance & Maxey (2003) and Yeo & Maxey (2010); the correction still is large there.
    pub const NARROW: f64 = 0.2;
    /// Gap below which lubrication grows no more unless the user says so.
    pub const CLOSEST: f64 = 1e-6;
    /// Fraction of the cutoff up to which the correction is whole.
    pub const TAPER: f64 = 0.75;

    /// Lubrication at gaps up to `cutoff`, and no stronger than at the gap `closest`.
    pub fn new(cutoff: f64, closest: f64) -> Result<Self, RangeError> {
        if !(cutoff > 1e-3 && cutoff <= FARTHEST) {
            return Err(RangeError::Cutoff(cutoff));
        }
        if !(closest >= 10.0 * CLOSEST && closest <= 0.1 * cutoff) {
            return Err(RangeError::Closest(closest));
        }
        Ok(Self { cutoff, closest, parts: false })
    }

    /// Gap where the correction ends, over the larger radius.
    pub fn cutoff(&self) -> f64 {
        self.cutoff
    }

    /// Gap below which the correction grows no more, over the mean radius.
    pub fn closest(&self) -> f64 {
        self.closest
    }

    /// The same for spheres that random motions press into each other: those that overlap are lubricated as at a gap as large as the
    /// overlap. At the closest gap forces would part them a million times more slowly, and random motions hardly at all.
    #[must_use]
    pub fn parting(self) -> Self {
        Self { parts: true, ..self }
    }

    /// The gap at which a correction is that of a gap, if the closest one is so large.
    #[inline(always)]
    pub(crate) fn counted(&self, gap: f64, closest: f64) -> f64 {
        let gap = if self.parts { gap.abs() } else { gap };
        gap.max(closest)
    }

    /// That of a sphere and a wall, both gaps over its radius: what the method misses does not reach as far as between spheres.
    #[must_use]
    pub fn at_wall(self) -> Self {
        Self { cutoff: self.cutoff.min(wall_table::FARTHEST), ..self }
    }

    /// Factor of the root of the correction at a gap over the larger radius, the square root of a quintic step from 1
    /// to 0.
    pub(crate) fn taper(&self, gap: f64) -> f64 {
        self.share(gap).sqrt()
    }

    /// Factor of the correction itself.
    #[inline(always)]
    pub(crate) fn share(&self, gap: f64) -> f64 {
        let x = ((1.0 - gap / self.cutoff) / (1.0 - Self::TAPER)).clamp(0.0, 1.0);
        x * x * x * (10.0 - x * (15.0 - 6.0 * x))
    }
}

impl Default for Range {
    fn default() -> Self {
        Self { cutoff: Self::WIDE, closest: Self::CLOSEST, parts: false }
    }
}
