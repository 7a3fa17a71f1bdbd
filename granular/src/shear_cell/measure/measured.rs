//! The measurements of a run so far: stresses on the walls with their errors, profile and map.

use super::super::{Engine, Model, Sampling, Side, Tally};
use super::{DensityMap, LayerProfile};
use domain::Vector;
use statistics::{Blocks, Estimate, State, Store};

/// Stress on a wall, averaged over windows of time (eq. 24), with errors by blocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallStress {
    /// The wall.
    pub side: Side,
    /// Normal stress: pressure is positive.
    pub normal: Estimate,
    /// Shear stress along the flow, positive where the grains drag the wall forward.
    pub along: Estimate,
    /// Shear stress across the flow: along z on bottom and top, along y on the sides.
    pub across: Estimate,
    /// Standard deviation of the normal stress over the windows.
    pub deviation: f64,
}

/// Time series of the normal stress, the shear stress along the flow and that across it on a wall, by windows.
#[derive(Debug, Clone, Default)]
pub struct WallSeries([Blocks; 3]);

impl WallSeries {
    /// Adds the impulse on a wall during a window.
    pub fn add(&mut self, model: &Model, side: Side, impulse: Vector, window: f64) {
        let stress = impulse / (model.area(side) * window);
        let normal = model.wall_contact(side, 0.0).normal();
        let stresses = [-stress.dot(normal), stress.x, stress.dot(side.across())];
        self.0.iter_mut().zip(stresses).for_each(|(blocks, stress)| blocks.add(stress));
    }

    pub fn stress(&self, side: Side) -> WallStress {
        let [normal, along, across] = self.0.each_ref().map(Blocks::estimate);
        WallStress { side, normal, along, across, deviation: self.0[0].deviation() }
    }
}

impl State for WallSeries {
    fn visit(&mut self, store: &mut dyn Store) {
        self.0[..].visit(store);
    }
}

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

    pub fn windows(&self) -> u64 {
        self.heights.count()
    }
}

impl State for Measurements {
    fn visit(&mut self, store: &mut dyn Store) {
        self.walls[..].visit(store);
        self.heights.visit(store);
        self.profile.visit(store);
        self.map.visit(store);
    }
}
