//! The measurements of a run so far.

use super::super::{Engine, Model, Sampling, Side, Tally};
use super::{DensityMap, LayerProfile, WallSeries};
use statistics::{Blocks, State, Store};

/// Stresses and heights for each window; profile and map for each sample.
#[derive(Debug, Clone)]
pub struct Measurements {
    pub walls: [WallSeries; 4],
    pub heights: Blocks,
    pub profile: LayerProfile,
    pub map: DensityMap,
}

impl Measurements {
    /// No measurements yet; profile and map up to `height`.
    pub fn new(model: &Model, height: f64, sampling: &Sampling) -> Self {
        Self {
            walls: Default::default(),
            heights: Blocks::default(),
            profile: LayerProfile::new(model, height, sampling.layers),
            map: DensityMap::new(model, height, sampling.pixels),
        }
    }

    /// Adds the window since the tally `before`, and a sample of profile and map if one is due.
    pub fn add(&mut self, model: &Model, engine: &Engine, before: &Tally, sampling: &Sampling) {
        for (wall, side) in self.walls.iter_mut().zip(Side::ALL) {
            let impulse = engine.tally().walls[side as usize].impulse - before.walls[side as usize].impulse;
            wall.add(model, side, impulse, sampling.window);
        }
        self.heights.add(engine.top_wall().height);
        if self.windows().is_multiple_of(sampling.every) {
            let grains = engine.grains();
            self.profile.add(model, &grains);
            self.map.add(model, &grains);
        }
    }

    /// Number of windows.
    pub fn windows(&self) -> u64 {
        self.heights.count()
    }
}

impl State for Measurements {
    fn visit(&mut self, store: &mut dyn Store) {
        self.walls.iter_mut().for_each(|wall| wall.visit(store));
        self.heights.visit(store);
        self.profile.visit(store);
        self.map.visit(store);
    }
}
