//! Requests to stop a computation before its end.

use std::sync::Arc;

/// Whether a computation is asked to stop: it looks here now and then, and ends early with [`Interrupted`]. Cheap to
/// copy, and the same for any of the program's threads.
#[derive(Clone, Default)]
pub struct Interrupt(Option<Arc<dyn Fn() -> bool + Send + Sync>>);

/// What a computation ends with when it was asked to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped on request")]
pub struct Interrupted;

impl Interrupt {
    /// No request ever comes.
    pub const NEVER: Self = Self(None);

    /// A request has come as soon as `asked` says so; from then on it needs to say so for ever. It is asked often.
    pub fn when(asked: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(asked)))
    }

    /// Whether this rank is asked to stop. Others may not be: a computation of several ranks agrees before it does.
    pub fn is_requested(&self) -> bool {
        self.0.as_ref().is_some_and(|asked| asked())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn every_copy_sees_a_request() {
        let flag = Arc::new(AtomicBool::new(false));
        let seen = flag.clone();
        let interrupt = Interrupt::when(move || seen.load(Ordering::Relaxed));
        let copy = interrupt.clone();
        assert!(!interrupt.is_requested() && !copy.is_requested() && !Interrupt::NEVER.is_requested());
        flag.store(true, Ordering::Relaxed);
        assert!(interrupt.is_requested() && copy.is_requested());
    }
}
