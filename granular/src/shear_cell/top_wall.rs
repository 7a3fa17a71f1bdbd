//! The top wall: fixed at its height, or free to move up and down under its load.

use super::Model;
use statistics::{State, Store};

/// Height and velocity of the top wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TopWall {
    /// Height above the bottom.
    pub height: f64,
    /// Upward velocity.
    pub velocity: f64,
}

impl TopWall {
    /// At the model's height, at rest.
    pub fn new(model: &Model) -> Self {
        Self { height: model.parameters().height, velocity: 0.0 }
    }

    /// Kinetic energy of a free top wall.
    pub fn energy(&self, model: &Model) -> f64 {
        0.5 * model.top_wall_mass().unwrap_or(0.0) * self.velocity * self.velocity
    }
}

impl State for TopWall {
    fn visit(&mut self, store: &mut dyn Store) {
        store.number(&mut self.height);
        store.number(&mut self.velocity);
    }
}
