//! Positions given by a user.

use crate::{Quaternion, Vector};

/// Positions from a file or a caller, optionally with radii, species and orientations.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GivenPositions {
    /// Their source, for messages.
    pub name: String,
    /// Positions.
    pub positions: Vec<Vector>,
    /// Radii, if they are known.
    pub radii: Option<Vec<f64>>,
    /// Species as indices from 0, if they are known.
    pub species: Option<Vec<u32>>,
    /// Orientations, if they are known.
    pub orientations: Option<Vec<Quaternion>>,
}
