//! Counts of parts of the particles.

use crate::{Histogram, PairDistribution, State};

/// An estimator that counts. Counts are whole numbers, which add up to the same in any order, so that each part of the particles may
/// have an estimator of its own until the counts of all are wanted.
pub trait Counts: State + Clone {
    /// Adds what was counted in another part at the same times.
    fn take_in(&mut self, other: &Self);

    /// Forgets what was counted.
    fn clear(&mut self);
}

impl Counts for Histogram {
    fn take_in(&mut self, other: &Self) {
        self.merge(other);
    }

    fn clear(&mut self) {
        *self = Self::default();
    }
}

impl Counts for PairDistribution {
    fn take_in(&mut self, other: &Self) {
        self.merge(other);
    }

    fn clear(&mut self) {
        self.forget();
    }
}
