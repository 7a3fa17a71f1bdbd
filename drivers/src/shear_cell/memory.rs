//! Predicted memory of runs of the shear cell.

use super::event_driven;
use super::measure::profile_bytes;
use super::{Collisions, Grains, Model, Motion, Sampling};
use domain::{Bytes, GROWING, Pairs, Particles, Vector};

/// Numbers of a grain in the particle store: velocity and spin.
const STORED: usize = 6;

impl Sampling {
    /// A run of so many grains with an engine: the grains, where they were at the last step, what is measured, and what
    /// packing them, a step and a checkpoint take besides.
    pub fn bytes(&self, model: &Model, count: usize, collisions: Collisions) -> Bytes {
        let count = count as f64;
        let grains = Grains::bytes(count);
        let engine = match collisions {
            Collisions::EventDriven => event_driven::bytes(model, count),
            Collisions::TimeStepped { .. } => stepped(count),
        };
        let measured = Bytes::keep(profile_bytes(self.layers, self.pixels));
        // They are measured, marked, and copied for a checkpoint.
        let kept = engine.then(grains).then(measured).then(measured);
        let stored = Particles::bytes(count, STORED);
        let checkpoint = grains.then(Bytes::keep(GROWING * stored.kept)).then(stored).then(measured).then(measured);
        let renewal = grains.then(grains).then(engine);
        packing(model, count).or(kept.then(checkpoint.freed().or(renewal.freed())))
    }
}

impl Grains {
    /// So many.
    fn bytes(count: f64) -> Bytes {
        Bytes::list::<(Vector, Motion)>(count)
    }
}

/// Grains on a time step: places, velocities and spins, and pairs, of which dense grains have half a dozen each.
fn stepped(count: f64) -> Bytes {
    let pairs = 6.0 * count;
    let search = Pairs::bytes(count, count, 2.0 * pairs / count).freed();
    Bytes::list::<[Vector; 3]>(count).then(Bytes::list::<(u32, u32, Vector)>(GROWING * pairs)).then(search)
}

/// Packing: places by cell, each a list of its own of four places in the allocator's units, and an engine in which the
/// grains grow.
fn packing(model: &Model, count: f64) -> Bytes {
    let by_cell = Bytes::list::<([i64; 3], Vec<Vector>, [Vector; 4], [u64; 2])>(count);
    let engine = event_driven::bytes(model, count);
    let grown = Grains::bytes(count).then(engine).then(Grains::bytes(count));
    by_cell.freed().or(grown.then(engine).freed())
}
