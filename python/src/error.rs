//! Errors of the libraries as Python exceptions.

use pyo3::prelude::*;
use pyo3::types::PyType;
use run::RunError;
use scene::SceneError;
use std::error::Error;

/// An exception `Error` with this message.
pub fn error(message: impl Into<String>) -> PyErr {
    raised("Error", message.into())
}

/// An exception `InputError` with this message.
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

/// The exception `Error` for an error of a library, with all its causes.
pub fn explained(cause: &dyn Error) -> PyErr {
    error(scene::in_full(cause))
}

/// The exception `InputError` for an error about an argument, with all its causes.
pub fn refused(cause: &dyn Error) -> PyErr {
    input_error(scene::in_full(cause))
}

/// The exception for an error of a run: `InputError` if it is about the scene, else `Error`.
pub fn of_run(cause: &RunError) -> PyErr {
    if matches!(cause, RunError::Scene(_)) { refused(cause) } else { explained(cause) }
}

/// The exception `InputError` for an error of a scene.
pub fn of_scene(cause: &SceneError) -> PyErr {
    refused(cause)
}
