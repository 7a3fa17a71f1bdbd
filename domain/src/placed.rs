//! Positions that somebody brings.

use crate::Vector;

/// Positions from outside, with what else is known of the particles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Placed {
    /// Where they are from, for messages.
    pub name: String,
    /// Positions.
    pub positions: Vec<Vector>,
    /// Radii, if they are known.
    pub radii: Option<Vec<f64>>,
    /// Species as indices from 0, if they are known.
    pub species: Option<Vec<u32>>,
}
