//! Ctrl-C and other signals handled by Python, as an interrupt flag for computations.

use domain::Interrupt;
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Shortest time between two checks of Python's signals: computations ask often.
const PAUSE: Duration = Duration::from_millis(20);

/// Exception raised by a signal handler, if any.
#[derive(Clone, Default)]
pub struct PythonSignals(Arc<Mutex<Heard>>);

#[derive(Default)]
struct Heard {
    looked: Option<Instant>,
    raised: Option<PyErr>,
}

impl PythonSignals {
    /// Interrupt flag for computations.
    pub fn interrupt(&self) -> Interrupt {
        let signals = self.clone();
        Interrupt::when(move || signals.poll())
    }

    /// Whether a signal handler has raised an exception.
    fn poll(&self) -> bool {
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

    /// Takes the exception that was raised, if any.
    pub fn take(&self) -> Option<PyErr> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).raised.take()
    }
}

/// Runs the handlers of pending signals, and returns the exception that they raise.
fn handled(py: Python<'_>) -> Option<PyErr> {
    py.check_signals().err()
}
