//! Forecasts of the memory of estimators that store numbers of every particle or pair.

use crate::{Blocks, ChannelProfile, Lagrangian, PairDistribution};
use domain::Bytes;

impl Lagrangian {
    /// Memory for `particles` particles after `samples` samples: the levels, each with twice the time lag of the one
    /// before.
    pub fn bytes(particles: f64, samples: u64) -> Bytes {
        let levels = f64::from(samples.checked_ilog2().map_or(0, |doubled| doubled + 1));
        Bytes::list::<usize>(particles).then(Bytes::list::<[[f64; Self::WIDTH]; Self::KEPT]>(levels * particles))
    }
}

impl PairDistribution {
    /// Memory for `species` species, whose pairs are counted by `threads` threads.
    pub fn bytes(species: usize, threads: usize) -> Bytes {
        let bins = (species * (species + 1) / 2) as f64 * Self::BINS as f64;
        // Each thread's cells are counted in several parts.
        Bytes::list::<f64>(bins).then(Bytes::list::<u32>(4.0 * threads as f64 * bins).freed())
    }
}

impl ChannelProfile {
    /// Memory for `species` species in `bins` bins after `samples` samples: every series has blocks of each power of
    /// two.
    pub fn bytes(species: usize, bins: usize, samples: u64) -> Bytes {
        let levels = f64::from(samples.checked_ilog2().map_or(1, |doubled| doubled + 1));
        let series = ((species + 1) * bins * Self::SERIES) as f64;
        Bytes::keep(series * levels.min(32.0) / 32.0 * Blocks::MOST_BYTES as f64)
    }
}
