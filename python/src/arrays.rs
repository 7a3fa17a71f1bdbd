//! Arrays of numpy and lists of the libraries.

use domain::{Traceless, Vector};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

/// Numbers by row: `(N, W)`, C-contiguous.
pub type Rows<'py> = PyReadonlyArray2<'py, f64>;

/// The rows of an array as vectors; nothing for no array.
pub fn vectors(rows: Option<Rows<'_>>) -> PyResult<Vec<Vector>> {
    let Some(rows) = rows else { return Ok(Vec::new()) };
    Ok(rows.as_slice()?.chunks_exact(3).map(Vector::from_slice).collect())
}

/// The rows of an array as tensors `(xx, xy, xz, yy, yz)`; nothing for no array.
pub fn tensors(rows: Option<Rows<'_>>) -> PyResult<Vec<Traceless>> {
    let Some(rows) = rows else { return Ok(Vec::new()) };
    let tensor = |row: &[f64]| Traceless(std::array::from_fn(|k| row[k]));
    Ok(rows.as_slice()?.chunks_exact(5).map(tensor).collect())
}

/// An array of shape `(N, 3)`.
pub fn of_vectors<'py>(py: Python<'py>, list: &[Vector]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    of_rows(py, list.iter().flat_map(Vector::to_array).collect(), 3)
}

/// An array of shape `(N, 5)`.
pub fn of_tensors<'py>(py: Python<'py>, list: &[Traceless]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    of_rows(py, list.iter().flat_map(|tensor| tensor.0).collect(), 5)
}

/// An array of rows of the same width, which takes the list over without a copy.
pub fn of_rows<T: numpy::Element>(py: Python<'_>, flat: Vec<T>, width: usize) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = flat.len() / width;
    PyArray1::from_vec(py, flat).reshape([rows, width])
}
