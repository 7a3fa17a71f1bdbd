//! Simulations of scenes that are advanced in steps.

use crate::arrays::{rows_of, table_of};
use crate::communicator::ranks;
use crate::error::{explained, of_run, refused};
use crate::neighbours::PyNeighbours;
use crate::run::{AdvanceOutcome, Run};
use crate::scene::parsed;
use crate::snapshot::{Moved, PySnapshot, rearrangement};
use crate::thread_bound::{ThreadBound, without_lock};
use crate::user_loads::{LoadKind, OwnFunction};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use run::{ExistingRun, RunError};
use simulation::Frame;
use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

/// A simulation.
#[pyclass(frozen, name = "Simulation", module = "fcm_solve._core")]
pub struct PySimulation {
    run: ThreadBound<Run>,
    notes: Vec<String>,
}

/// A row of the time series: for each quantity its name and unit, the names of rows and columns if it is a table, and
/// its numbers.
type ObservableRow = Vec<(Cow<'static, str>, &'static str, Option<(Vec<String>, Vec<String>)>, Vec<f64>)>;

#[pymethods]
impl PySimulation {
    /// Starts a scene, given by its text and name. `out` is the folder of the results and whether a run in it is
    /// replaced.
    #[staticmethod]
    #[pyo3(signature = (scene, out, comm))]
    fn start(
        py: Python<'_>,
        scene: (String, String),
        out: Option<(PathBuf, bool)>,
        comm: Option<(i32, String)>,
    ) -> PyResult<Self> {
        let comm = ranks(comm)?;
        let text = comm.broadcast_text(&scene.0);
        let scene = parsed(&text, &scene.1, &[])?;
        let folder = out.or_else(|| scene.kind().folder().map(|folder| (folder.to_owned(), false)));
        let former = |force| if force { ExistingRun::Replace } else { ExistingRun::Keep };
        let folder = folder.as_ref().map(|(path, force)| (path.as_path(), former(*force)));
        let run = without_lock(py, || Run::start(scene, folder, &comm)).map_err(|cause| of_run(&cause))?;
        Ok(Self { run: ThreadBound::new(run), notes: Vec::new() })
    }

    /// Resumes the run of a folder from its last checkpoint; `accepted` has the keys of the scene whose change is
    /// accepted.
    #[staticmethod]
    #[pyo3(signature = (folder, accepted, comm))]
    fn resume(py: Python<'_>, folder: PathBuf, accepted: Vec<String>, comm: Option<(i32, String)>) -> PyResult<Self> {
        let comm = ranks(comm)?;
        let (run, notes) =
            without_lock(py, || Run::resume(&folder, &accepted, &comm)).map_err(|cause| of_run(&cause))?;
        Ok(Self { run: ThreadBound::new(run), notes })
    }

    /// Advances to a step.
    fn run_to(&self, py: Python<'_>, step: u64) -> PyResult<()> {
        let ended = self.run.with(py, |run| run.run_to(step))?;
        if let Some(raised) = self.raised(py)? {
            return Err(raised);
        }
        match ended.map_err(|cause| of_run(&cause))? {
            AdvanceOutcome::AtItsStep => Ok(()),
            AdvanceOutcome::Interrupted => Err(self.run.with(py, |run| run.interruption())?),
        }
    }

    /// Adds a load function, which returns "forces", "torques", forces and "moments", or forces of "pairs" nearer than
    /// a cutoff.
    #[pyo3(signature = (function, gives, cutoff))]
    fn add_loads(&self, py: Python<'_>, function: Py<PyAny>, gives: &str, cutoff: Option<f64>) -> PyResult<()> {
        let loads = OwnFunction { function: Arc::new(function), gives: LoadKind::of(gives, cutoff)? };
        let added = self.run.with(py, |run| run.add_loads(loads))?;
        match self.raised(py)? {
            Some(raised) => Err(raised),
            None => added.map_err(|cause| of_run(&cause)),
        }
    }

    /// The pairs of particles whose centres are nearer than a cutoff, on the first rank.
    fn neighbours(&self, py: Python<'_>, cutoff: f64) -> PyResult<PyNeighbours> {
        let found = self.run.with(py, |run| run.simulation.neighbours(cutoff))?;
        Ok(PyNeighbours::of(found.map_err(|cause| refused(&cause))?))
    }

    /// The present state.
    fn snapshot(&self, py: Python<'_>) -> PyResult<PySnapshot> {
        self.run.with(py, Run::snapshot)
    }

    /// Goes back to a state with changes: `moved` has ids and values of changed positions, velocities, angular
    /// velocities and orientations, `radii` those of changed radii.
    fn restore(
        &self,
        py: Python<'_>,
        snapshot: &PySnapshot,
        moved: (Moved<'_>, Moved<'_>, Moved<'_>, Moved<'_>),
        radii: (Vec<u64>, Vec<f64>),
    ) -> PyResult<()> {
        let change = rearrangement(moved, radii)?;
        let restored = self.run.with(py, |run| run.restore(snapshot, change))?;
        match self.raised(py)? {
            Some(raised) => Err(raised),
            None => restored.map_err(|cause| match cause {
                RunError::File(_) | RunError::Folder { .. } => explained(&cause),
                _ => refused(&cause),
            }),
        }
    }

    /// Writes a checkpoint.
    fn checkpoint(&self, py: Python<'_>) -> PyResult<()> {
        self.run.with(py, Run::checkpoint)?.map_err(|cause: RunError| of_run(&cause))
    }

    /// Writes a last checkpoint and releases the folder.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.run.with(py, Run::close)?.map_err(|cause: RunError| of_run(&cause))
    }

    /// Steps taken, and the time.
    fn clock(&self, py: Python<'_>) -> PyResult<(u64, f64)> {
        self.run.with(py, |run| (run.simulation.clock().step(), run.simulation.clock().time()))
    }

    /// The scene's last step.
    fn end(&self, py: Python<'_>) -> PyResult<u64> {
        self.run.with(py, |run| run.end())
    }

    /// The time step.
    fn time_step(&self, py: Python<'_>) -> PyResult<f64> {
        self.run.with(py, |run| run.simulation.clock().dt())
    }

    /// The plan of the computation, as text.
    fn plan(&self, py: Python<'_>) -> PyResult<String> {
        self.run.with(py, |run| run.simulation.plan())
    }

    /// Warnings at the start.
    fn cautions(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let cautions = self.run.with(py, |run| run.cautions())?;
        Ok(self.notes.iter().cloned().chain(cautions).collect())
    }

    /// Warnings at the end.
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.run.with(py, |run| run.simulation.warnings())
    }

    /// The present particles on the first rank, as a dict of arrays.
    fn frame<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let frame = self.run.with(py, |run| run.simulation.frame())?;
        by_name(py, frame)
    }

    /// The present values of the time series.
    fn observables(&self, py: Python<'_>) -> PyResult<ObservableRow> {
        self.run.with(py, |run| {
            let numbers = run.simulation.present_row();
            let quantities = run.simulation.quantities();
            quantities.into_iter().zip(numbers).map(|(q, numbers)| (q.name, q.unit, q.table, numbers)).collect()
        })
    }
}

impl PySimulation {
    fn raised(&self, py: Python<'_>) -> PyResult<Option<PyErr>> {
        self.run.with(py, |run| run.raised.take())
    }
}

fn by_name(py: Python<'_>, frame: Frame) -> PyResult<Bound<'_, PyDict>> {
    let Frame { particles, cell, .. } = frame;
    let lattice = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|steps| cell.lattice(steps));
    let items = PyDict::new(py);
    items.set_item("positions", rows_of::<_, f64>(py, particles.positions.into_vec())?)?;
    items.set_item("images", rows_of::<_, i32>(py, particles.steps.into_vec())?)?;
    items.set_item("lattice", rows_of::<_, f64>(py, lattice.to_vec())?)?;
    items.set_item("radii", PyArray1::from_vec(py, particles.radii))?;
    items.set_item("species", PyArray1::from_vec(py, particles.species))?;
    items.set_item("ids", PyArray1::from_vec(py, particles.ids))?;
    for column in particles.columns {
        items.set_item(&column.name, table_of(py, column.values.into_vec(), column.width)?)?;
    }
    Ok(items)
}
