//! Lists of numbers that are where they were computed until the host reads them.

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
}
