//! Requests to stop a computation before its end.

use std::sync::Arc;

/// A flag that asks a computation to stop. The computation checks it regularly and ends early with [`Interrupted`].
/// Copies are cheap and share the flag, also among threads.
#[derive(Clone, Default)]
pub struct Interrupt(Option<Arc<dyn Fn() -> bool + Send + Sync>>);

/// The error of a computation that was asked to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped on request")]
pub struct Interrupted;

impl Interrupt {
    /// A flag that is never set.
    pub const NEVER: Self = Self(None);

    /// Flag that is set when `asked` returns true, which it has to do from then on. It is called often.
    pub fn when(asked: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(asked)))
    }

    /// Whether this rank is asked to stop. Other ranks may not be: computations on several ranks agree before they
    /// stop.
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
