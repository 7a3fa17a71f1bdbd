//! What statistics take.

use domain::{Bytes, Vector};
use statistics::{Lagrangian, Motion, PairDistribution};

/// What they keep of so many particles after so many samples, of so many species, with so many threads.
pub fn bytes(particles: f64, samples: u64, (species, threads): (usize, usize)) -> Bytes {
    paths(particles).then(Lagrangian::bytes(particles, samples)).then(PairDistribution::bytes(species, threads))
}

/// Places, velocities and ways of [`super::Paths`].
fn paths(particles: f64) -> Bytes {
    Bytes::list::<[Vector; 3]>(particles)
}

/// What a sample of so many particles takes: velocities, turning, motions, and cells to find pairs in.
pub fn sample_bytes(particles: f64) -> Bytes {
    Bytes::list::<([Vector; 4], Motion, [u32; 3], usize)>(particles).freed()
}

/// The state as bytes.
pub fn state_bytes(particles: f64, samples: u64) -> f64 {
    paths(particles).then(Lagrangian::bytes(particles, samples)).kept
}
