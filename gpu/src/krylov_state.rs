//! Memory of Lanczos' iteration on a device.

use crate::buffers::Buffer;

/// Vectors of the basis at most, as in `gpu/kernels/task.h`.
pub const MOST_VECTORS: usize = 100;

/// Components of the load of a particle with dipoles, as in `gpu/kernels/krylov.h`.
pub(crate) const LOAD_COMPONENTS: usize = 11;

/// Numbers of the state before the products, of which the first one is the last vector.
pub(crate) const SCALARS: usize = 3;

/// Memory of the iteration.
#[derive(Default)]
pub(crate) struct KrylovBuffers {
    pub state: Buffer,
    pub scales: Buffer,
    pub remainder: Buffer,
    /// Sums of blocks.
    pub sums: Buffer,
    pub vectors: Vec<Buffer>,
    /// Number of vectors of the present basis.
    pub count: usize,
}
