//! Scenes without time steps, carried out as a whole.

use crate::error::{error, of_run};
use crate::scene::parsed;
use crate::thread_bound::without_lock;
use crate::threads::check_this_thread;
use domain::Comm;
use pyo3::prelude::*;
use run::{ExistingRun, Listener, RunError, RunFolder, WholeScene};
use scene::Scene;
use std::path::{Path, PathBuf};

/// Listener that passes lines on to a Python function.
struct PythonListener(Py<PyAny>);

impl Listener for PythonListener {
    fn line(&self, text: &str) {
        // Exceptions of the listener do not affect the run.
        let _ = Python::attach(|py| self.0.call1(py, (text,)).map(drop));
    }
}

/// Carries out a scene, given as text and name. `out` is the folder, unless the scene names one, and whether a run in
/// it is replaced; `goes_on` continues that run.
#[pyfunction]
#[pyo3(signature = (scene, out, goes_on, tell))]
pub fn carry_out(
    py: Python<'_>,
    scene: (String, String),
    out: Option<(PathBuf, bool)>,
    goes_on: bool,
    tell: Py<PyAny>,
) -> PyResult<()> {
    check_this_thread()?;
    let scene = parsed(&scene.0, &scene.1, &[])?;
    let folder = out.or_else(|| scene.kind().folder().map(|folder| (folder.to_owned(), false)));
    let nowhere = || error("a scene that is carried out as a whole needs a folder for its results: out=");
    let (path, force) = folder.ok_or_else(nowhere)?;
    let former = match (force, goes_on) {
        (true, _) => ExistingRun::Replace,
        (_, true) => ExistingRun::Continue,
        _ => ExistingRun::Keep,
    };
    let told = PythonListener(tell);
    without_lock(py, || in_folder(&scene, &path, former, &told)).map_err(|cause| of_run(&cause))
}

fn in_folder(scene: &Scene, path: &Path, former: ExistingRun, listener: &PythonListener) -> Result<(), RunError> {
    let comm = Comm::alone();
    let work = WholeScene::of(scene).ok_or(RunError::NoSteps)?;
    let mut folder = RunFolder::claim(path, &comm, former)?;
    run::check_memory(scene.kind(), &comm)?;
    if former != ExistingRun::Continue || !folder.holds_run(&comm) {
        folder.start_with(scene.text())?;
    }
    work.carry_out(scene, &folder, &comm, listener)
}
