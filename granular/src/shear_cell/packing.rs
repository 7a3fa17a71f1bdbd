//! Random packings by the algorithm of Lubachevsky and Stillinger (1990): grains that grow while they move.

use super::event_driven::GrowingDiameter;
use super::grains::periodic_box;
use super::{
    CellModel, CellParameters, CellState, CollisionEngine, CollisionRule, EventDriven, FrictionLaw, GrainMotion, Grains,
};
use crate::error::JammedPacking;
use crate::fraction::without_unit;
use domain::{Occupied, Random, Vector};

/// Solid fraction of the random sequential addition at the start.
const INITIAL_FRACTION: f64 = 0.2;
/// Growth rates over the thermal speed, tried in turn: slower growth reaches denser packings.
const GROWTH_RATES: [f64; 4] = [0.1, 0.03, 0.01, 0.003];
/// The grains count as jammed when a lap takes less than this time, in units of the diameter over the thermal speed.
const JAMMED_LAP: f64 = 3e-4;
/// Collisions per grain between two times at which velocities are rescaled to remove the heat of
/// growth, and after growth.
const COLLISIONS_PER_GRAIN: u64 = 10;
/// Positions tried for each grain.
const TRIES: usize = 10_000;

impl CellModel {
    /// `count` grains at random positions, without overlap, at rest. The same seed gives the same positions, in
    /// diameters, in any unit of length.
    pub fn pack(&self, count: usize, seed: u64) -> Result<Grains, JammedPacking> {
        self.pack_with_progress(count, seed, &mut |_| {})
    }

    /// Like [`CellModel::pack`]; `tell` is called from time to time with the fraction of the diameter
    /// that the grains have reached.
    pub fn pack_with_progress(
        &self,
        count: usize,
        seed: u64,
        tell: &mut dyn FnMut(f64),
    ) -> Result<Grains, JammedPacking> {
        let p = self.parameters();
        let [length, height, width, diameter] = without_unit([p.length, p.height, p.width, p.diameter]);
        let elastic_at_rest = self.elastic_at_rest(Vector::new(length, height, width) / diameter);
        let fraction = count as f64 * std::f64::consts::PI / 6.0 * diameter.powi(3) / (length * height * width);
        let mut reached: f64 = 0.0;
        for growth in GROWTH_RATES {
            let size = GrowingDiameter { diameter: f64::min(f64::cbrt(INITIAL_FRACTION / fraction), 1.0), growth };
            match elastic_at_rest.grow(count, seed, size, tell) {
                Ok(mut grains) => {
                    grains.motions.fill(GrainMotion::default());
                    grains.positions.iter_mut().for_each(|x| *x *= self.parameters().diameter);
                    return Ok(grains);
                }
                Err(diameter) => reached = reached.max(fraction * diameter.powi(3)),
            }
        }
        Err(JammedPacking { wanted: fraction, reached })
    }

    /// The same cell at rest with elastic, smooth contacts, in units of the diameter and the thermal speed.
    fn elastic_at_rest(&self, edges: Vector) -> CellModel {
        let contact = CollisionRule { restitution: 1.0, friction: 0.0, law: FrictionLaw::Box };
        self.with(CellParameters { contact_time: 1e-12, ..CellParameters::of_gas(edges, 1.0, 1.0, contact) })
    }

    /// Grows grains to a diameter of 1; on failure, the diameter reached.
    fn grow(&self, count: usize, seed: u64, size: GrowingDiameter, tell: &mut dyn FnMut(f64)) -> Result<Grains, f64> {
        let mut grains = self.scatter(count, size.diameter, seed).ok_or(0.0)?;
        grains.set_velocities(self, 1.0, seed);
        let mut engine = EventDriven::growing(self, &CellState::new(self, &grains), size);
        let lap = COLLISIONS_PER_GRAIN * count as u64;
        while engine.diameter() < 1.0 - 1e-13 {
            let (before, left) = (engine.tally().time, (1.0 - engine.diameter()) / size.growth);
            engine.run(left, lap, &|| true);
            tell(engine.diameter());
            if engine.tally().time - before < f64::min(JAMMED_LAP, 0.5 * left) {
                return Err(engine.diameter());
            }
            engine.scale_velocities(1.0 / engine.grains().temperature().sqrt());
        }
        let full = GrowingDiameter { diameter: 1.0, growth: 0.0 };
        // The last flights end at a diameter that differs from the full one by round-off.
        let mut engine = EventDriven::growing(self, &CellState::new(self, &engine.grains()), full);
        engine.run(f64::INFINITY, lap, &|| true);
        Ok(engine.grains())
    }

    /// Random sequential addition: random positions, each kept if it is at least a diameter
    /// away from all previous ones.
    fn scatter(&self, count: usize, diameter: f64, seed: u64) -> Option<Grains> {
        let margin = Vector::from(std::array::from_fn(|k| if self.is_walled(k) { 0.5 * diameter } else { 0.0 }));
        let (room, cell) = (self.edges() - 2.0 * margin, periodic_box(self, diameter, self.edges().y));
        let mut occupied = Occupied::new(&cell, &[(0.5 * diameter, count)], None);
        let mut positions = Vec::with_capacity(count);
        for i in 0..count {
            let mut random = Random::new(seed, i as u64);
            let mut tries = (0..TRIES).map(|_| margin + room * random.point());
            let position = tries.find(|&x| occupied.is_free(0.5 * diameter, x, None))?;
            occupied.insert(0.5 * diameter, position);
            positions.push(position);
        }
        Some(Grains { motions: vec![GrainMotion::default(); count], positions })
    }
}
