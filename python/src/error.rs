//! Errors of the libraries as exceptions of Python.

use io::{RunError, SceneError};
use pyo3::prelude::*;
use pyo3::types::PyType;
use std::error::Error;

/// An `Error` with this message.
pub fn error(message: impl Into<String>) -> PyErr {
    raised("Error", message.into())
}

/// An `InputError` with this message.
pub fn input_error(message: impl Into<String>) -> PyErr {
    raised("InputError", message.into())
}

fn raised(kind: &str, message: String) -> PyErr {
    let of_kind = |py: Python<'_>| {
        let kind = py.import("fcm_solve._errors")?.getattr(kind)?.cast_into::<PyType>()?;
        Ok(PyErr::from_type(kind, message))
    };
    Python::attach(of_kind).unwrap_or_else(|not_found: PyErr| not_found)
}

/// An error of a library, with all its causes.
pub fn explained(cause: &dyn Error) -> PyErr {
    error(io::in_full(cause))
}

/// The same of what is wrong with an argument.
pub fn refused(cause: &dyn Error) -> PyErr {
    input_error(io::in_full(cause))
}

/// An error of a run, which may be one of its scene.
pub fn of_run(cause: &RunError) -> PyErr {
    if matches!(cause, RunError::Scene(_)) { refused(cause) } else { explained(cause) }
}

/// An error of a scene.
pub fn of_scene(cause: &SceneError) -> PyErr {
    refused(cause)
}
