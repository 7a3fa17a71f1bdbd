//! The ranks: this process alone, or the processes of an mpi4py communicator.

#[cfg(feature = "mpi")]
use crate::error::explained;
#[cfg(not(feature = "mpi"))]
use crate::error::input_error;
use domain::Comm;
use pyo3::prelude::*;

/// The ranks of an mpi4py communicator, given by its handle `comm.py2f()` and the name of its library; without one,
/// this process alone.
pub fn ranks(comm: Option<(i32, String)>) -> PyResult<Comm> {
    match comm {
        None => Ok(Comm::alone()),
        Some((handle, library)) => of_handle(handle, &library),
    }
}

#[cfg(feature = "mpi")]
fn of_handle(handle: i32, library: &str) -> PyResult<Comm> {
    Comm::of_handle(handle, library).map_err(|cause| explained(&cause))
}

#[cfg(not(feature = "mpi"))]
fn of_handle(_handle: i32, _library: &str) -> PyResult<Comm> {
    Err(input_error(
        "comm is given, but this package was built without MPI; build it with MPI as its documentation says, by \
         MATURIN_PEP517_ARGS=\"--features mpi\" pip install ./python",
    ))
}
