//! The measurements of a run so far: stresses on the walls with their errors, profile and map.

use super::super::{CellModel, CellTally, Engine, Sampling, Side};
use super::{DensityMap, InitialBalance, LayerProfile};
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

/// Energy and momentum at the start; stresses and heights for each window; profile and map for each sample.
#[derive(Debug, Clone)]
pub struct Measurements {
    pub start: InitialBalance,
    /// Normal stress, shear stress along the flow and shear stress across it on each wall.
    stresses: [[Blocks; 3]; 4],
    pub heights: Blocks,
    pub profile: LayerProfile,
    pub map: DensityMap,
}

impl Measurements {
    /// No measurements yet; profile and map up to `height`.
    pub fn new(model: &CellModel, engine: &Engine, height: f64, sampling: &Sampling) -> Self {
        Self {
            start: InitialBalance::new(model, engine),
            stresses: Default::default(),
            heights: Blocks::default(),
            profile: LayerProfile::new(model, height, sampling.layers),
            map: DensityMap::new(model, height, sampling.pixels),
        }
    }

    /// Adds the window since the tally `before`, and a sample of profile and map if one is due.
    pub fn add(&mut self, model: &CellModel, engine: &Engine, before: &CellTally, sampling: &Sampling) {
        for (side, series) in Side::ALL.into_iter().zip(&mut self.stresses) {
            let impulse = engine.tally().walls[side as usize].impulse - before.walls[side as usize].impulse;
            let stress = impulse / (model.area(side) * sampling.window);
            let stresses = [-stress.dot(side.normal()), stress.x, stress.dot(side.across())];
            series.iter_mut().zip(stresses).for_each(|(blocks, stress)| blocks.add(stress));
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

    pub fn wall(&self, side: Side) -> WallStress {
        let series = &self.stresses[side as usize];
        let [normal, along, across] = series.each_ref().map(Blocks::estimate);
        WallStress { side, normal, along, across, deviation: series[0].deviation() }
    }
}

impl State for Measurements {
    fn visit(&mut self, store: &mut dyn Store) {
        self.start.visit(store);
        self.stresses.as_flattened_mut().visit(store);
        self.heights.visit(store);
        self.profile.visit(store);
        self.map.visit(store);
    }
}
