//! Counts over parts of the particles.

use crate::{Histogram, PairDistribution, State};

/// An estimator that counts. Counts are integers, whose sums are the same in any order, so each part of the particles
/// may have its own estimator until the counts of all are needed.
pub trait Counts: State + Clone {
    /// Adds the counts of another part at the same times.
    fn merge(&mut self, other: &Self);

    /// Sets the counts to zero.
    fn clear(&mut self);
}

impl Counts for Histogram {
    fn merge(&mut self, other: &Self) {
        self.merge(other);
    }

    fn clear(&mut self) {
        *self = Self::default();
    }
}

impl Counts for PairDistribution {
    fn merge(&mut self, other: &Self) {
        self.merge(other);
    }

    fn clear(&mut self) {
        self.clear_counts();
    }
}
