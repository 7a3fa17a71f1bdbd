//! The file that a run starts from, and the data taken from it.

use crate::RunError;
use domain::{Comm, GivenPositions};
use files::positions::{self, Fitted};
use files::{FileError, StartFile, read_start};
use scene::{GranularDisksScene, Kind, Scene, StartSource, SuspensionScene};

/// The scene with the strain of the box in its start file, unless the scene sets one; and messages for the user about
/// the file, on the first rank. Collective.
pub fn with_start_file(scene: Scene, comm: &Comm) -> Result<(Scene, Vec<String>), RunError> {
    let source = match scene.kind() {
        Kind::Suspension(checked) => checked.start.as_ref(),
        Kind::GranularDisks(checked) => checked.start.as_ref(),
        _ => None,
    };
    let Some(source) = source else { return Ok((scene, Vec::new())) };
    let read = if comm.is_first() { taken_strain(&scene, source).map(Some) } else { Ok(None) };
    let mut strain: Vec<f64> = comm.agree(read)?.flatten().into_iter().collect();
    comm.broadcast(&mut strain);
    let scene = match strain[..] {
        [strain] => scene.with("the strain of the box that it starts from", &[format!("box.strain={strain:?}")])?,
        _ => scene,
    };
    let notes = if comm.is_first() { notes(&scene).map(Some) } else { Ok(None) };
    Ok((scene, comm.agree(notes)?.unwrap_or_default()))
}

/// Strain to set, if the scene has none and the box of the file has one.
fn taken_strain(scene: &Scene, source: &StartSource) -> Result<Option<f64>, FileError> {
    let file = read_start(source)?;
    let found = match scene.kind() {
        Kind::Suspension(scene) if scene.strain.is_none() => positions::strain_for_spheres(&file, &scene.model),
        Kind::GranularDisks(scene) if scene.strain.is_none() => {
            positions::strain_for_disks(&file, scene.model.parameters())
        }
        _ => return Ok(None),
    };
    let strain = found.map_err(|reason| FileError::start(&source.path, &reason))?;
    Ok((strain != 0.0).then_some(strain))
}

/// Messages about the file.
fn notes(scene: &Scene) -> Result<Vec<String>, FileError> {
    Ok(match scene.kind() {
        Kind::Suspension(scene) => of_spheres(scene)?.map(|fitted| fitted.notes),
        Kind::GranularDisks(scene) => of_disks(scene)?.map(|fitted| fitted.notes),
        _ => None,
    }
    .unwrap_or_default())
}

/// Spheres of the file, if the scene starts from one.
pub(super) fn of_spheres(scene: &SuspensionScene) -> Result<Option<Fitted>, FileError> {
    scene.start.as_ref().map(|source| fitted(source, |file| positions::spheres(file, &scene.model))).transpose()
}

/// Disks of the file, if the scene starts from one.
pub(super) fn of_disks(scene: &GranularDisksScene) -> Result<Option<Fitted>, FileError> {
    let parameters = scene.model.parameters();
    scene.start.as_ref().map(|source| fitted(source, |file| positions::disks(file, parameters))).transpose()
}

fn fitted(source: &StartSource, fit: impl FnOnce(StartFile) -> Result<Fitted, String>) -> Result<Fitted, FileError> {
    let file = read_start(source)?;
    let (count, frame) = (file.positions.len(), file.frame);
    let Fitted { given, notes } = fit(file).map_err(|reason| FileError::start(&source.path, &reason))?;
    let name = source.path.display().to_string();
    let has_frames = frame.count > 1 || frame.step.is_some() || frame.time.is_some();
    let frame = if has_frames { format!(", {frame}") } else { String::new() };
    let first = format!("{count} particles of {name}{frame}");
    Ok(Fitted { given: GivenPositions { name, ..given }, notes: [first].into_iter().chain(notes).collect() })
}

#[cfg(test)]
mod tests;
