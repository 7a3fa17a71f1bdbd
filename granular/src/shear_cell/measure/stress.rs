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

/// Time series of the stress on a wall, one value per window.
#[derive(Debug, Clone, Default)]
pub struct WallSeries {
    normal: Blocks,
    along: Blocks,
    across: Blocks,
}

impl WallSeries {
    /// Adds the impulse on a wall during a window.
    pub fn add(&mut self, model: &Model, side: Side, impulse: Vector, window: f64) {
        let stress = impulse / (model.area(side) * window);
        let across = if side.axis() == 1 { Vector::Z } else { Vector::Y };
        self.normal.add(-stress.dot(model.face(side, 0.0).normal()));
        self.along.add(stress.x);
        self.across.add(stress.dot(across));
    }

    /// The averages so far.
    pub fn stress(&self, side: Side) -> WallStress {
        let [normal, along, across] = [&self.normal, &self.along, &self.across].map(Blocks::estimate);
        WallStress { side, normal, along, across, deviation: self.normal.deviation() }
    }
}

impl State for WallSeries {
    fn visit(&mut self, store: &mut dyn Store) {
        for blocks in [&mut self.normal, &mut self.along, &mut self.across] {
            blocks.visit(store);
        }
    }
}
