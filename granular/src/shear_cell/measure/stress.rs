//! Mean stress on a wall and its error.

use super::super::{Model, Side};
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

    /// The averages so far.
    pub fn stress(&self, side: Side) -> WallStress {
        let [normal, along, across] = self.0.each_ref().map(Blocks::estimate);
        WallStress { side, normal, along, across, deviation: self.0[0].deviation() }
    }
}

impl State for WallSeries {
    fn visit(&mut self, store: &mut dyn Store) {
        self.0.iter_mut().for_each(|blocks| blocks.visit(store));
    }
}
