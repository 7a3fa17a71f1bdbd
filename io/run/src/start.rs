//! Simulation of a scene, at its start or in the state of a checkpoint.

use crate::RunError;
use crate::memory::check_memory;
use crate::start_file;
use domain::{Comm, GivenPositions};
use files::FileError;
use files::positions::Fitted;
use granular::disks::{DiskRun, RunLength};
use granular::shear_cell::CellRun;
use scene::{GranularDisksScene, Kind, Scene, SuspensionScene};
use simulation::{Simulation, State};
use suspension::SuspensionRun;

/// Simulation of a scene at its start. `tell` is called now and then with the completed fraction of
/// the preparation. Collective.
pub fn start(scene: &Scene, comm: &Comm, tell: &mut dyn FnMut(f64)) -> Result<Box<dyn Simulation>, RunError> {
    check_memory(scene.kind(), comm)?;
    Ok(match scene.kind() {
        Kind::Suspension(scene) => Box::new(SuspensionRun::start(&scene.model, start_positions(scene, comm)?, comm)?),
        Kind::GranularDisks(scene) => {
            let placed = disk_positions(scene, comm)?;
            Box::new(DiskRun::start(&scene.model, run_length(scene), placed.as_ref(), comm, tell)?)
        }
        Kind::ShearCell(scene) => Box::new(CellRun::start(&scene.experiment, comm, tell)?),
        Kind::Continuum(_) => return Err(RunError::NoSteps),
    })
}

/// Simulation of a scene in the state of a checkpoint, of which each rank passes its share. Collective.
pub fn resume(scene: &Scene, state: Option<State>, comm: &Comm) -> Result<Box<dyn Simulation>, RunError> {
    check_memory(scene.kind(), comm)?;
    Ok(match (scene.kind(), state) {
        (Kind::Suspension(scene), state) => Box::new(SuspensionRun::resume(&scene.model, state, comm)?),
        (Kind::GranularDisks(scene), Some(state)) => {
            let from_file = scene.start.is_some();
            Box::new(DiskRun::resume(&scene.model, run_length(scene), &state, from_file, comm)?)
        }
        (Kind::ShearCell(scene), Some(state)) => Box::new(CellRun::resume(&scene.experiment, &state, comm)?),
        _ => return Err(RunError::NoSteps),
    })
}

/// Starting positions of a scene's spheres, if they are read from a file; on the first rank. Collective.
pub fn start_positions(scene: &SuspensionScene, comm: &Comm) -> Result<Option<GivenPositions>, RunError> {
    on_first(comm, || start_file::of_spheres(scene))
}

/// Starting positions of a scene's disks, if they are read from a file; on the first rank. Collective.
pub(super) fn disk_positions(scene: &GranularDisksScene, comm: &Comm) -> Result<Option<GivenPositions>, RunError> {
    on_first(comm, || start_file::of_disks(scene))
}

fn on_first(
    comm: &Comm,
    read: impl FnOnce() -> Result<Option<Fitted>, FileError>,
) -> Result<Option<GivenPositions>, RunError> {
    let read = if comm.is_first() { read() } else { Ok(None) };
    Ok(comm.agree(read)?.map(|fitted| fitted.given))
}

fn run_length(scene: &GranularDisksScene) -> RunLength {
    RunLength { steps: scene.time.steps, profile_strips: scene.profile_strips }
}
