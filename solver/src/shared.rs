//! Memory that threads write concurrently, each at its own positions.

/// Pointer to memory that is shared between threads.
pub(crate) struct Shared<T>(*mut T);

// SAFETY: users of the pointer guarantee that no two threads access the same values.
unsafe impl<T: Send> Send for Shared<T> {}
unsafe impl<T: Send> Sync for Shared<T> {}

impl<T> Shared<T> {
    /// Values of a slice; the borrow is not tracked.
    pub fn new(values: &mut [T]) -> Self {
        Self(values.as_mut_ptr())
    }

    /// Values from a pointer on.
    pub fn from_pointer(first: *mut T) -> Self {
        Self(first)
    }

    /// Pointer to the value at `offset` from the first.
    ///
    /// # Safety
    /// The value is one of the slice.
    pub unsafe fn at(&self, offset: usize) -> *mut T {
        // SAFETY: guaranteed by the caller.
        unsafe { self.0.add(offset) }
    }
}
