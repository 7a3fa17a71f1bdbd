//! Memory that threads write at the same time, each its own places.

/// A place in memory that other threads may go to as well.
pub(crate) struct Shared<T>(*mut T);

// SAFETY: whoever uses the pointer promises that no two threads touch the same values.
unsafe impl<T: Send> Send for Shared<T> {}
unsafe impl<T: Send> Sync for Shared<T> {}

impl<T> Shared<T> {
    /// The values of a slice, which stays borrowed for as long as its user says: not at all, here.
    pub fn new(values: &mut [T]) -> Self {
        Self(values.as_mut_ptr())
    }

    /// The values from a pointer on.
    pub fn from_pointer(first: *mut T) -> Self {
        Self(first)
    }

    /// The value that stands `offset` places after the first.
    ///
    /// # Safety
    /// It is one of the slice's.
    pub unsafe fn at(&self, offset: usize) -> *mut T {
        // SAFETY: the caller's promise.
        unsafe { self.0.add(offset) }
    }
}
