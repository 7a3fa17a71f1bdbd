//! HTML pages about runs.

use crate::error::explained;
use crate::thread_bound::without_lock;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Writes an HTML page about the run in a folder.
#[pyfunction]
pub fn write_report(py: Python<'_>, folder: PathBuf, out: PathBuf) -> PyResult<()> {
    without_lock(py, || report::write_report(&folder, &out)).map_err(|cause| explained(&cause))
}
