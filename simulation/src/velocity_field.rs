//! Velocity fields.

use domain::{PeriodicBox, Vector};

/// The velocity of the fluid on a grid at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityField {
    /// Number of steps taken.
    pub step: u64,
    /// Time of the field.
    pub time: f64,
    /// The box.
    pub cell: PeriodicBox,
    /// Position of the first point.
    pub origin: Vector,
    /// Distances of the points along each axis, which is that of the lattice in a sheared box.
    pub spacing: Vector,
    /// Points along x, y and z.
    pub points: [usize; 3],
    /// Whether each axis is periodic, with points over the whole period.
    pub periodic: [bool; 3],
    /// Velocities in the order `[z][y][x]`, x fastest; on the first rank.
    pub values: Vec<Vector>,
    /// Description of the kind of velocity.
    pub note: &'static str,
}
