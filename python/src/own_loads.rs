//! Functions of Python that give forces or torques.

use crate::arrays::{list_of, rows_of};
use domain::Vector;
use pyo3::prelude::*;
use simulation::{AppliedLoads, LoadFunction};
use std::cell::RefCell;
use std::error::Error;
use std::rc::Rc;
use std::sync::Arc;

/// A function of Python `(positions, time) -> (N, 3)` that gives forces, or torques.
#[derive(Clone)]
pub struct OwnLoads {
    pub function: Arc<Py<PyAny>>,
    pub torques: bool,
}

/// What such functions have raised, until somebody takes it.
#[derive(Clone, Default)]
pub struct Raised(Rc<RefCell<Option<PyErr>>>);

impl Raised {
    /// What was raised; it is forgotten here.
    pub fn take(&self) -> Option<PyErr> {
        self.0.borrow_mut().take()
    }

    /// Whether anything was raised.
    pub fn is_any(&self) -> bool {
        self.0.borrow().is_some()
    }

    /// Loads by a function whose array is checked when it comes: a load, or an error that says what was raised.
    pub fn loads(&self, own: OwnLoads) -> LoadFunction {
        let raised = self.clone();
        Box::new(move |positions, time| {
            let called = Python::attach(|py| called(py, &own.function, (positions, time)));
            match called {
                Ok(list) if own.torques => Ok(AppliedLoads { torques: list, ..AppliedLoads::default() }),
                Ok(list) => Ok(AppliedLoads { forces: list, ..AppliedLoads::default() }),
                Err(error) => Err(raised.keep(error)),
            }
        })
    }

    fn keep(&self, error: PyErr) -> Box<dyn Error> {
        let message = error.to_string();
        self.0.replace(Some(error));
        message.into()
    }
}

fn called(py: Python<'_>, function: &Py<PyAny>, (positions, time): (&[Vector], f64)) -> PyResult<Vec<Vector>> {
    let rows = function.bind(py).call1((rows_of::<_, f64>(py, positions.to_vec())?, time))?;
    list_of(Some(rows.extract()?))
}
