//! Frames of a trajectory.

use domain::{Bytes, Particles, PeriodicBox};

/// All particles at one time, in the order of their ids, and their box.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Particles, with the columns that are written: any of `velocity`, `angular_velocity` and `stresslet`.
    pub particles: Particles,
    /// The box.
    pub cell: PeriodicBox,
    /// Whether each axis is periodic.
    pub periodic: [bool; 3],
}

/// Default size up to which HDF5 caches chunks of a dataset.
const CACHE: f64 = (1 << 20) as f64;

impl Frame {
    /// Memory for writing a frame of `particles` particles whose columns have `numbers` numbers: the chunks of
    /// positions, images and each column that HDF5 caches, if they are small enough; without the blocks of particles
    /// that are gathered, [`domain::ById`].
    pub fn bytes(particles: f64, numbers: usize) -> Bytes {
        let chunks = [3.0 * 8.0, 3.0 * 4.0, 8.0 * numbers as f64].map(|width| width * particles);
        Bytes::keep(chunks.into_iter().map(|bytes| if bytes > CACHE { 0.0 } else { bytes }).sum())
    }
}
