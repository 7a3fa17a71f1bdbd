//! Ctrl-C and other signals of Python, as computations ask for them.

use domain::Interrupt;
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two looks: computations ask often.
const PAUSE: Duration = Duration::from_millis(20);

/// What the handlers of signals have raised, if anything.
#[derive(Clone, Default)]
pub struct Signals(Arc<Mutex<Heard>>);

#[derive(Default)]
struct Heard {
    looked: Option<Instant>,
    raised: Option<PyErr>,
}

impl Signals {
    /// For computations to look at.
    pub fn interrupt(&self) -> Interrupt {
        let signals = self.clone();
        Interrupt::when(move || signals.look())
    }

    /// Whether a handler has raised anything.
    fn look(&self) -> bool {
        let mut heard = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if heard.raised.is_some() {
            return true;
        }
        if heard.looked.is_none_or(|looked| looked.elapsed() >= PAUSE) {
            heard.looked = Some(Instant::now());
            heard.raised = Python::attach(handled);
        }
        heard.raised.is_some()
    }

    /// What was raised; it is forgotten here.
    pub fn take(&self) -> Option<PyErr> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).raised.take()
    }
}

/// Runs the handlers of signals that have come; what they raise.
fn handled(py: Python<'_>) -> Option<PyErr> {
    py.check_signals().err()
}
