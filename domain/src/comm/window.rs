//! Shared memory of the ranks on one machine.

use super::Comm;
use bytemuck::{Pod, Zeroable};
use std::cell::UnsafeCell;
use std::sync::Arc;

/// Memory of each rank of a group, initially zero, which every rank on the same machine can read and write, made by
/// [`Comm::window`]. It is aligned to a cache line.
///
/// Values written by one rank are visible to another after both have called [`Window::barrier`].
pub struct Window {
    /// By rank of the group; `None` for those on other machines.
    parts: Vec<Option<Arc<Segment>>>,
    machine: Comm,
}

impl Window {
    pub(super) fn new(group: &Comm, machine: Comm, segments: Vec<Arc<Segment>>) -> Self {
        let mut parts = vec![None; group.size()];
        for (rank, segment) in machine.all_gather(&[group.rank()]).into_iter().zip(segments) {
            parts[rank] = Some(segment);
        }
        Self { parts, machine }
    }

    /// Pointer to the memory of a rank of the group, if it is on this machine.
    pub fn of<T: Pod>(&self, rank: usize) -> Option<*mut T> {
        self.parts[rank].as_ref().map(|segment| segment.start().cast())
    }

    /// Whether some ranks of the group are on other machines.
    pub fn is_divided(&self) -> bool {
        self.machine.size() < self.parts.len()
    }

    /// Waits for the ranks of the group on this machine.
    pub fn barrier(&self) {
        if self.machine.size() > 1 {
            self.machine.barrier();
        }
    }
}

/// A rank's part of a window.
pub(super) enum Segment {
    /// Allocated by this process.
    Private(Box<[UnsafeCell<CacheLine>]>),
    /// Shared by several processes.
    #[cfg(all(feature = "mpi", target_os = "linux"))]
    Mapped(super::mapped::SharedMapping),
}

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct CacheLine([u64; 8]);

// SAFETY: it is plain memory; users of the pointer synchronise by barriers.
unsafe impl Send for Segment {}
unsafe impl Sync for Segment {}

impl Segment {
    pub(super) fn private(bytes: usize) -> Self {
        Self::Private(
            (0..bytes.div_ceil(size_of::<CacheLine>())).map(|_| UnsafeCell::new(CacheLine::zeroed())).collect(),
        )
    }

    fn start(&self) -> *mut u8 {
        match self {
            Self::Private(lines) => UnsafeCell::raw_get(lines.as_ptr()).cast(),
            #[cfg(all(feature = "mpi", target_os = "linux"))]
            Self::Mapped(memory) => memory.start(),
        }
    }
}
