//! The four walls of a shear cell.

use super::CellModel;
use bytemuck::{Pod, Zeroable};
use domain::Vector;

/// The walls, in the order of their tallies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// `y = 0`: moves with the trough.
    Bottom,
    /// `y = H`: at rest along x.
    Top,
    /// `z = 0`: the outer side wall, moves with the trough.
    Outer,
    /// `z = W`: the inner side wall, moves with the trough.
    Inner,
}

impl Side {
    /// All four walls.
    pub const ALL: [Self; 4] = [Self::Bottom, Self::Top, Self::Outer, Self::Inner];

    /// Axis of the normal.
    pub fn axis(self) -> usize {
        1 + self as usize / 2
    }

    /// Unit normal into the grains.
    pub fn normal(self) -> Vector {
        [Vector::Y, Vector::NEG_Y, Vector::Z, Vector::NEG_Z][self as usize]
    }

    /// Direction across the flow in the plane of the wall: along z on bottom and top, along y on the sides.
    pub(super) fn across(self) -> Vector {
        if self.axis() == 1 { Vector::Z } else { Vector::Y }
    }

    /// The wall that bounds an axis (1 or 2) from below or above.
    pub(super) fn of(axis: usize, below: bool) -> Self {
        Self::ALL[2 * (axis - 1) + usize::from(!below)]
    }
}

/// Height and velocity of the top wall, which is fixed or free to move up and down under its load.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TopWall {
    /// Height above the bottom.
    pub height: f64,
    /// Upward velocity.
    pub velocity: f64,
}

impl TopWall {
    /// At the model's height, at rest.
    pub fn new(model: &CellModel) -> Self {
        Self { height: model.parameters().height, velocity: 0.0 }
    }

    /// Kinetic energy of a free top wall.
    pub fn energy(&self, model: &CellModel) -> f64 {
        0.5 * model.top_wall_mass().unwrap_or(0.0) * self.velocity * self.velocity
    }
}
