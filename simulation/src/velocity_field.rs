//! Velocity fields.

use domain::{PeriodicBox, Vector};

/// The velocity of the fluid on a grid at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityField {
    /// Steps taken.
    pub step: u64,
    /// The time.
    pub time: f64,
    /// The box.
    pub cell: PeriodicBox,
    /// The place of the first point.
    pub first: Vector,
    /// Distances of the points along each axis: of the lattice, in a sheared box.
    pub spacing: Vector,
    /// Points along x, y and z.
    pub points: [usize; 3],
    /// Along which axes the box repeats: there the points go around it.
    pub periodic: [bool; 3],
    /// Velocities in the order `[z][y][x]`, x fastest; on the first rank.
    pub values: Vec<Vector>,
    /// What kind of velocity it is, in words.
    pub note: &'static str,
}
