//! Values that may be used only on the thread that made them.

use crate::error::error;
use crate::threads;
use pyo3::prelude::*;
use std::cell::RefCell;
use std::thread::ThreadId;

/// A value that is confined to the thread that made it, since MPI allows calls from one thread alone, and communicators
/// are counted without locks. Other threads are refused.
pub struct ThreadBound<T> {
    value: Option<RefCell<T>>,
    home: ThreadId,
}

// SAFETY: the value is accessed through `with` alone, which refuses all threads but its home thread, and is dropped
// there alone.
unsafe impl<T> Send for ThreadBound<T> {}
// SAFETY: as above; on the home thread, the cell refuses a second use during the first.
unsafe impl<T> Sync for ThreadBound<T> {}

/// A closure that is called without Python's lock, on the same thread.
struct SameThread<F>(F);

// SAFETY: `Python::detach` calls the closure at once, on the calling thread.
unsafe impl<F> Send for SameThread<F> {}

impl<F: FnOnce() -> R, R> SameThread<F> {
    fn call(self) -> SameThread<R> {
        SameThread((self.0)())
    }
}

/// Runs a computation on this thread without Python's lock, so that other Python threads go on.
pub fn without_lock<R>(py: Python<'_>, compute: impl FnOnce() -> R) -> R {
    let here = SameThread(compute);
    py.detach(move || here.call()).0
}

impl<T> ThreadBound<T> {
    /// Confines a value to this thread.
    pub fn new(value: T) -> Self {
        Self { value: Some(RefCell::new(value)), home: std::thread::current().id() }
    }

    /// Calls a function with the value, without Python's lock.
    pub fn with<R>(&self, py: Python<'_>, using: impl FnOnce(&mut T) -> R) -> PyResult<R> {
        threads::check_this_thread()?;
        if std::thread::current().id() != self.home {
            return Err(error("this object belongs to the thread that made it; use it there"));
        }
        let busy = |_| error("it is in the midst of a computation; functions of forces are given positions and time");
        let mut value = self.value.as_ref().expect("until it is dropped").try_borrow_mut().map_err(busy)?;
        Ok(without_lock(py, || using(&mut value)))
    }
}

impl<T> Drop for ThreadBound<T> {
    fn drop(&mut self) {
        if std::thread::current().id() != self.home {
            std::mem::forget(self.value.take());
        }
    }
}
