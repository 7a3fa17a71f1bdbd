//! Lists of numbers that are where they were computed until the host reads them.

use crate::{PeriodicBox, Tensor};
use std::sync::Arc;

/// A list of numbers of particles, in the order of their ids, that another memory than the host's holds. Clones stand
/// for the same list, which its holder may release when all of them but its own are gone.
#[derive(Debug, Clone, Default)]
pub struct RemoteList(Arc<()>);

impl RemoteList {
    /// A list that no other stands for.
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether there are no clones.
    pub fn is_alone(&self) -> bool {
        Arc::strong_count(&self.0) == 1
    }
}

impl PartialEq for RemoteList {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Eq for RemoteList {}

/// A memory that holds lists of numbers of particles.
pub trait RemoteHolder {
    /// Copies of lists that it holds, in the order of the particles' ids.
    fn copies(&self, lists: &[&RemoteList]) -> Vec<Vec<f64>>;

    /// Copies a list in the order of ids to it.
    fn hold(&self, values: &[f64]) -> RemoteList;

    /// Moves particles whose positions it holds, and wraps them into a box; `None` if a particle is lost.
    fn advance(&self, displaced: &RemoteDisplacement) -> Option<RemoteAdvance>;
}

/// Particles in a remote memory, by columns whose rows are in the order of their ids.
pub struct RemoteDisplacement<'a> {
    /// Positions.
    pub positions: &'a RemoteList,
    /// Lattice steps that were taken out of the positions.
    pub steps: &'a RemoteList,
    /// Displacements, as columns of vectors and their weights.
    pub terms: &'a [(RemoteList, f64)],
    /// Columns of velocities in a flow.
    pub velocities: &'a [RemoteList],
    /// The box and the flow.
    pub frame: RemoteFrame<'a>,
}

/// A flow in a periodic box in which particles in a remote memory move.
#[derive(Clone, Copy)]
pub struct RemoteFrame<'a> {
    /// The box after a displacement.
    pub cell: &'a PeriodicBox,
    /// Velocity gradient of the flow by which images move relative to their particles.
    pub gradient: Tensor,
    /// Deformation, by the flow, of the positions after a displacement and of velocities.
    pub deformation: Tensor,
    /// Matrix that converts lattice steps before to those along the vectors of the box, modulo `2^32`.
    pub renaming: [[i32; 3]; 3],
    /// Distance from the box, in edges, from which on a displaced particle is lost.
    pub farthest: f64,
}

impl<'a> RemoteFrame<'a> {
    /// A flow that deforms nothing in a box whose lattice vectors stay the same.
    pub fn new(cell: &'a PeriodicBox, gradient: Tensor, farthest: f64) -> Self {
        let renaming = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
        Self { cell, gradient, deformation: Tensor::IDENTITY, renaming, farthest }
    }
}

/// Particles after a displacement.
pub struct RemoteAdvance {
    /// Positions inside the box.
    pub positions: RemoteList,
    /// Lattice steps that were taken out of the positions.
    pub steps: RemoteList,
    /// Velocities in the frames of reference of these positions.
    pub velocities: Vec<RemoteList>,
}
