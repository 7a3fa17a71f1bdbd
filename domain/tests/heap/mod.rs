//! Counts allocations. A test that uses it has a program of its own, with no other test beside it.

use domain::Bytes;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

struct Counting;

static NOW: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

#[global_allocator]
static HEAP: Counting = Counting;

// SAFETY: all work is done by the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        MOST.fetch_max(NOW.fetch_add(layout.size(), Relaxed) + layout.size(), Relaxed);
        // SAFETY: the caller keeps to the same contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller keeps to the same contract.
        unsafe { System.dealloc(place, layout) }
    }

    /// In place, if there is room behind it.
    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        NOW.fetch_sub(layout.size(), Relaxed);
        MOST.fetch_max(NOW.fetch_add(size, Relaxed) + size, Relaxed);
        // SAFETY: the caller keeps to the same contract.
        unsafe { System.realloc(place, layout, size) }
    }
}

/// Result of a call, and the memory that it has allocated.
pub fn measured<T>(call: impl FnOnce() -> T) -> (T, Bytes) {
    let before = NOW.load(Relaxed);
    MOST.store(before, Relaxed);
    let result = call();
    let (kept, most) = (NOW.load(Relaxed) as f64 - before as f64, (MOST.load(Relaxed) - before) as f64);
    (result, Bytes { kept, most })
}
