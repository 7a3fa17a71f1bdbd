//! The box together with its decomposition.

use crate::{Comm, Partition, PeriodicBox};

/// The box and its decomposition over the ranks: the domain in which all ranks search or move particles.
#[derive(Clone, Copy)]
pub struct DomainView<'a> {
    /// The box.
    pub cell: &'a PeriodicBox,
    /// The share of the box that each rank owns.
    pub partition: &'a Partition,
}

impl<'a> DomainView<'a> {
    /// The ranks.
    pub fn comm(&self) -> &'a Comm {
        self.partition.comm()
    }
}
