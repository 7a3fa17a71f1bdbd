//! Memory of the statistics.

use super::{channel_bins, numbers};
use crate::model::Model;
use domain::{Boundaries, Bytes, IdBlocks, Particles, Quaternion, Tensor, Vector, shared_pairs_bytes};
use statistics::{ChannelProfile, Lagrangian, PairDistribution, TrackedMotion};

/// Numbers of particles of a rank, for its share of the statistics.
#[derive(Debug, Clone, Copy)]
pub struct RankCounts {
    /// Particles that it owns.
    pub owned: f64,
    /// Particles and ghosts within the largest distance of pairs.
    pub present: f64,
    /// Particles of its blocks of ids.
    pub redistributed: f64,
    /// Whether it is the first rank, which holds everything that does not belong to a block.
    pub is_first: bool,
    /// Whether it has all particles in the order of their ids, so that they need not be redistributed.
    pub is_in_order: bool,
}

impl RankCounts {
    /// A single rank with all particles in the order of their ids.
    pub fn alone(particles: f64) -> Self {
        Self { owned: particles, present: particles, redistributed: particles, is_first: true, is_in_order: true }
    }

    /// Memory that persists after a number of samples, with the given number of threads.
    pub fn bytes(self, model: &Model, samples: u64, threads: usize) -> Bytes {
        let species = model.species.len();
        let pairs = if has_pairs(model) { PairDistribution::bytes(species, threads) } else { Bytes::default() };
        self.followed(model, samples).then(pairs).then(self.profile(model, samples))
    }

    /// Paths and past velocities of its blocks, and rotations if there are orientations.
    fn followed(self, model: &Model, samples: u64) -> Bytes {
        let past = Lagrangian::bytes(self.redistributed, samples);
        // Positions, velocities and paths of [`super::Paths`].
        let paths = Bytes::list::<[Vector; 3]>(self.redistributed).then(past);
        if model.has_orientations() {
            paths.then(Bytes::list::<(Quaternion, Vector)>(self.redistributed)).then(past)
        } else {
            paths
        }
    }

    /// Profile across a channel.
    fn profile(self, model: &Model, samples: u64) -> Bytes {
        let bins = channel_bins(model).filter(|_| self.is_first).unwrap_or(0);
        ChannelProfile::bytes(model.species.len(), bins, samples)
    }

    /// Memory of a sample: pairs, or redistributed particles with velocities, angular velocities and motions.
    pub fn sample_bytes(self, model: &Model) -> Bytes {
        let copy = Particles::bytes(self.owned, 0).then(Particles::migration_bytes(self.owned));
        let copy = if self.present > self.owned { copy } else { Bytes::default() };
        let pairs = copy.then(shared_pairs_bytes(self.owned, self.present));
        let redistributed = IdBlocks::distribution_bytes([self.owned, self.redistributed], numbers(model));
        let redistributed = if self.is_in_order { Bytes::default() } else { redistributed };
        let stresslets =
            Bytes::list::<(Tensor, f64)>(if channel_bins(model).is_some() { self.redistributed } else { 0.0 });
        let passes = Bytes::list::<([Vector; 5], TrackedMotion)>(self.redistributed).then(stresslets);
        if has_pairs(model) {
            pairs.freed().or(redistributed.then(passes).freed())
        } else {
            redistributed.then(passes).freed()
        }
    }

    /// Bytes of its share of the serialised state.
    pub fn state_bytes(self, model: &Model, samples: u64) -> f64 {
        self.followed(model, samples).then(self.profile(model, samples)).kept
    }
}

fn has_pairs(model: &Model) -> bool {
    model.cell.boundaries() == Boundaries::Periodic
}
