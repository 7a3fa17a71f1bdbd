//! An entry of a neighbour list.

/// A neighbour of a particle: its row among local particles and ghosts, and the lattice steps to its nearest image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Neighbour {
    /// Row of the neighbour.
    pub row: u32,
    /// Lattice steps added to the neighbour's position.
    pub steps: [i8; 3],
}
