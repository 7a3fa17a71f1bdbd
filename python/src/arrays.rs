//! Conversions between numpy arrays and the libraries' lists.

use bytemuck::{Pod, allocation::cast_vec, cast_slice};
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArrayDyn};
use pyo3::prelude::*;

/// Rows of numbers: `(N, W)`, C-contiguous.
pub type Rows<'py> = PyReadonlyArray2<'py, f64>;

/// The rows of an array as a list of vectors or tensors `(xx, xy, xz, yy, yz)`; an empty list without an array.
pub fn list_of<T: Pod>(rows: Option<Rows<'_>>) -> PyResult<Vec<T>> {
    let Some(rows) = rows else { return Ok(Vec::new()) };
    Ok(cast_slice(rows.as_slice()?).to_vec())
}

/// An array of shape `(N, W)` from a list of vectors, tensors or lattice steps, which it takes over without a copy.
pub fn rows_of<T: Pod, N: Element + Pod>(py: Python<'_>, list: Vec<T>) -> PyResult<Bound<'_, PyArray2<N>>> {
    table_of(py, cast_vec(list), size_of::<T>() / size_of::<N>())
}

/// An array with rows of a width, which takes the list over without a copy.
pub fn table_of<N: Element>(py: Python<'_>, flat: Vec<N>, width: usize) -> PyResult<Bound<'_, PyArray2<N>>> {
    let rows = flat.len() / width;
    PyArray1::from_vec(py, flat).reshape([rows, width])
}

/// Whether all numbers of a C-contiguous array are finite, without the temporary array that numpy would make.
#[pyfunction]
pub fn is_finite(array: PyReadonlyArrayDyn<'_, f64>) -> PyResult<bool> {
    Ok(array.as_slice()?.iter().all(|value| value.is_finite()))
}
