//! Ranks, the periodic box, the domain decomposition, particles and their near pairs. Everything else in the project
//! builds on these types; they are independent of the fluid.
//!
//! Lengths are in any unit. Example: random positions for spheres at 20% by volume, and their neighbours:
//! ```
//! use domain::{Neighbours, PeriodicBox, Vector, random_packing};
//!
//! let cell = PeriodicBox::new(Vector::splat(12.0))?;
//! let radii = vec![1.0; 82];
//! let positions = random_packing(&cell, &radii, 0.1, 1)?;
//! let neighbours = Neighbours::find(&cell, &positions, positions.len(), 3.0);
//! for (row, &position) in positions.iter().enumerate() {
//!     for near in neighbours.of(row).iter() {
//!         let distance = cell.nearest_image(positions[near.row as usize] - position).length();
//!         assert!((2.1 - 1e-9..3.0).contains(&distance));
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axis_rotation;
mod block;
mod body_shape;
mod boundaries;
mod by_id;
mod cells;
mod column;
mod comm;
mod domain_view;
mod given_positions;
mod halo;
mod id_blocks;
mod interrupt;
mod memory;
mod neighbour;
mod neighbours;
mod number;
mod packing;
mod pairs;
pub mod parallel;
mod parameter;
mod particles;
mod partition;
mod periodic_box;
mod quaternion;
mod random;
pub mod remote_columns;
mod remote_list;
#[cfg(test)]
mod remote_memory;
mod rows;
mod scalars;
mod shared_pairs;
pub mod sphere;
mod traceless;
mod units;
mod verlet_list;
mod walls;

pub use axis_rotation::AxisRotation;
pub use block::{block, block_of};
pub use body_shape::{BodyShape, BodySphere, EqualSpheres};
pub use boundaries::Boundaries;
pub use by_id::ById;
pub use column::{Column, ColumnError, ColumnValues, ParticleValues};
pub use comm::{Comm, CommError, Failure, Incoming, Launcher, Outgoing, Window};
pub use domain_view::DomainView;
pub use given_positions::GivenPositions;
pub use halo::{Halo, Reach};
pub use id_blocks::IdBlocks;
pub use interrupt::{Interrupt, Interrupted};
pub use memory::{
    AvailableMemory, Bytes, ExpectedCounts, GROWING, MemoryNeed, NotEnoughMemory, Process, ProcessMemory,
    packing_bytes, readable_bytes, shared_pairs_bytes,
};
pub use neighbour::Neighbour;
pub use neighbours::{Neighbours, NeighboursOf};
pub use number::Number;
pub use packing::{Occupied, PackingError, random_cloud, random_packing, shared_random_packing};
pub use pairs::{Pair, Pairs, fold_pairs};
pub use parameter::{ParameterError, refused, require};
pub use particles::{Particles, saved_state::SavedState};
pub use partition::{Partition, Place};
pub use periodic_box::{BoxError, PeriodicBox};
pub use quaternion::Quaternion;
pub use random::{Random, RandomLanes};
pub use remote_list::{RemoteAdvance, RemoteDisplacement, RemoteFrame, RemoteHolder, RemoteList};
pub use scalars::{Scalar, Scalars};
pub use shared_pairs::fold_shared_pairs;
pub use traceless::Traceless;
pub use units::{Units, power_of_two};
pub use verlet_list::{LocalAndGhosts, VerletList};
pub use walls::ToWall;

/// A vector of three components in `f64`.
pub type Vector = glam::DVec3;
/// A 3 x 3 tensor in `f64`, stored by columns as glam does: `tensor.col(j)[i]` is component `ij`.
pub type Tensor = glam::DMat3;
