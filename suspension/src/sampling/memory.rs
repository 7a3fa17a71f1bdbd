//! What statistics take.

use super::channel_bins;
use crate::model::Model;
use domain::{Boundaries, Bytes, Vector};
use statistics::{ChannelProfile, Lagrangian, Motion, PairDistribution};

/// What they keep of so many particles of a scene after so many samples, with so many threads.
pub fn bytes(model: &Model, particles: f64, (samples, threads): (u64, usize)) -> Bytes {
    let is_periodic = model.cell.boundaries() == Boundaries::Periodic;
    let pairs = if is_periodic { PairDistribution::bytes(model.species.len(), threads) } else { Bytes::default() };
    paths(particles).then(Lagrangian::bytes(particles, samples)).then(pairs).then(profile(model, samples))
}

/// Places, velocities and ways of [`super::Paths`].
fn paths(particles: f64) -> Bytes {
    Bytes::list::<[Vector; 3]>(particles)
}

/// What a profile across a channel keeps.
fn profile(model: &Model, samples: u64) -> Bytes {
    ChannelProfile::bytes(model.species.len(), channel_bins(model).unwrap_or(0), samples)
}

/// What a sample of so many particles takes: velocities, turning, motions, and cells to find pairs in.
pub fn sample_bytes(particles: f64) -> Bytes {
    Bytes::list::<([Vector; 4], Motion, [u32; 3], usize)>(particles).freed()
}

/// The state as bytes.
pub fn state_bytes(model: &Model, particles: f64, samples: u64) -> f64 {
    paths(particles).then(Lagrangian::bytes(particles, samples)).then(profile(model, samples)).kept
}
