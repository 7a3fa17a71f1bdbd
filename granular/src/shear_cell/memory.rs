//! Predicted memory of runs of the shear cell.

use super::event_driven;
use super::measure::profile_bytes;
use super::{CellModel, CollisionDetection, GrainMotion, Sampling};
use domain::{Bytes, GROWING, Pairs, Particles, Vector};

/// Values of a grain in the particle store: velocity and spin.
const STORED: usize = 6;

impl Sampling {
    /// Predicted memory of a run with `count` grains: engine, grains at the last step and measurements, and
    /// temporarily packing, a step or a checkpoint.
    pub fn bytes(&self, model: &CellModel, count: usize, collisions: CollisionDetection) -> Bytes {
        let count = count as f64;
        let grains = Bytes::list::<(Vector, GrainMotion)>(count);
        let event_driven = event_driven::bytes(model, count);
        let engine = match collisions {
            CollisionDetection::EventDriven => event_driven,
            CollisionDetection::TimeStepped { .. } => {
                // Half a dozen per grain when dense.
                let pairs = 6.0 * count;
                let search = Pairs::bytes(count, count, 2.0 * pairs / count).freed();
                grains.then(Bytes::list::<(u32, u32, Vector)>(GROWING * pairs)).then(search)
            }
        };
        // An engine in which the grains grow, and one in which they have grown. The start takes less.
        let packing = grains.then(event_driven).then(grains).then(event_driven).freed();
        let measured = Bytes::keep(profile_bytes(self.layers, self.pixels));
        // Measurements: the current ones, those of the last restart, and copies for a checkpoint.
        let kept = engine.then(grains).then(measured).then(measured);
        let stored = Particles::bytes(count, STORED);
        let checkpoint = grains.then(Bytes::keep(GROWING * stored.kept)).then(stored).then(measured).then(measured);
        let renewal = grains.then(grains).then(engine);
        packing.or(kept.then(checkpoint.freed().or(renewal.freed())))
    }
}
