//! What files take while they are written.

use crate::Table;
use domain::Bytes;

/// Chunks that HDF5 keeps of each dataset at most, by default.
const CACHE: f64 = (1 << 20) as f64;

/// The chunks of a trajectory of so many particles, with columns of so many numbers, that HDF5 keeps: those of
/// positions, of images and of each column, where they are small enough.
pub fn frame_bytes(particles: f64, numbers: usize) -> Bytes {
    let chunks = [3.0 * 8.0, 3.0 * 4.0, 8.0 * numbers as f64].map(|width| width * particles);
    Bytes::keep(chunks.into_iter().map(|bytes| if bytes > CACHE { 0.0 } else { bytes }).sum())
}

impl Table {
    /// A table of so many rows of numbers, each row a list of its own with what the allocator notes of it, and its text.
    pub fn bytes(rows: f64, columns: usize) -> Bytes {
        let numbers = Bytes::list::<f64>((columns + 1) as f64 * rows);
        let text = Bytes::keep(rows * columns as f64 * CHARACTERS);
        Bytes::list::<(Vec<String>, Vec<f64>)>(rows).then(numbers).then(text.freed())
    }
}

/// Characters of a number in CSV, on average.
const CHARACTERS: f64 = 16.0;
