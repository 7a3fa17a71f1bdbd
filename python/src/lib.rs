//! The compiled part of the Python package: converts arrays and errors between Python and the libraries. The interface
//! for users is the package `fcm_solve` in the folder of this crate.

#![allow(clippy::needless_pass_by_value, reason = "arguments of Python come as values")]

mod arrays;
mod communicator;
mod error;
mod family;
mod mobility;
mod neighbours;
mod report;
mod run;
mod scene;
mod signals;
mod simulation;
mod snapshot;
mod thread_bound;
mod threads;
mod user_loads;
mod whole_scene;

use pyo3::prelude::*;

/// The compiled part of `fcm_solve`.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("LUBRICATION_CUTOFF", lubrication::LubricationRange::WIDE)?;
    module.add("has_mpi", cfg!(feature = "mpi"))?;
    module.add_class::<mobility::PyMobility>()?;
    module.add_class::<simulation::PySimulation>()?;
    module.add_class::<snapshot::PySnapshot>()?;
    module.add_class::<neighbours::PyNeighbours>()?;
    module.add_function(wrap_pyfunction!(arrays::is_finite, module)?)?;
    module.add_function(wrap_pyfunction!(threads::start_threads, module)?)?;
    module.add_function(wrap_pyfunction!(scene::template, module)?)?;
    module.add_function(wrap_pyfunction!(scene::read, module)?)?;
    module.add_function(wrap_pyfunction!(scene::check, module)?)?;
    module.add_function(wrap_pyfunction!(family::claim_family, module)?)?;
    module.add_function(wrap_pyfunction!(family::write_family, module)?)?;
    module.add_function(wrap_pyfunction!(report::write_report, module)?)?;
    module.add_function(wrap_pyfunction!(whole_scene::carry_out, module)?)
}
