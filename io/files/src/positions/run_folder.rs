//! Positions from the folder of a run: a frame of the trajectory, or the last checkpoint if there is no trajectory.

use super::species::SpeciesColumn;
use super::{FileBox, StartFile, TakenFrame, frame};
use crate::{Checkpoints, FileError, Latest};
use domain::{Comm, PeriodicBox, Quaternion, Vector};
use scene::{Kind, Scene, StartSource};
use simulation::State;
use suspension::ORIENTATION;

pub(super) fn read(source: &StartSource) -> Result<StartFile, FileError> {
    let (folder, trajectory) = (&source.path, source.path.join("trajectory.h5"));
    if trajectory.exists() {
        return super::read_start(&StartSource { path: trajectory, ..source.clone() });
    }
    let unfit = |reason: String| FileError::start(folder, &reason);
    if !Checkpoints::of(folder).any()? {
        return Err(unfit("the folder has neither trajectory.h5 nor checkpoints of a run".to_owned()));
    }
    frame::pick(source.frame, 1).map_err(|reason| unfit(format!("{reason}: the run wrote no trajectory.h5")))?;
    let Latest { state, .. } = Checkpoints::of(folder).latest(&Comm::alone()).map_err(|e| unfit(e.to_string()))?;
    let scene = Scene::read(&folder.join("scene.toml"), &[]).map_err(|e| unfit(e.to_string()))?;
    of_state(state, &scene).map_err(unfit)
}

/// Particles of a checkpoint, in the axes of the user.
fn of_state(state: State, scene: &Scene) -> Result<StartFile, String> {
    let oriented = state.particles.columns.iter().find(|column| column.name == ORIENTATION);
    let mut orientations: Option<Vec<Quaternion>> =
        oriented.map(|column| bytemuck::cast_slice(&column.values).to_vec());
    let mut positions = state.particles.positions;
    let (cell, time_step) = match scene.kind() {
        Kind::Suspension(scene) if scene.model.cell.axes().is_some() => {
            return Err(
                "its run has an extension, whose box checkpoints do not say; start from a trajectory".to_owned()
            );
        }
        Kind::Suspension(scene) => {
            let (cell, axes) = (&scene.model.cell, scene.model.user_axes());
            for position in &mut positions {
                *position = axes.place(*position);
            }
            for orientation in orientations.iter_mut().flatten() {
                *orientation = axes.orientation(*orientation);
            }
            let edges = Vector::from_array(axes.list(cell.edges().to_array()));
            let periodic = axes.list([0, 1, 2].map(|axis| cell.is_periodic(axis)));
            (FileBox { periodic, ..sheared(edges, state.strain)? }, scene.model.time_step)
        }
        Kind::GranularDisks(scene) => {
            let parameters = scene.model.parameters();
            let [length, height] = parameters.edges;
            let cell = sheared(Vector::new(length, height, 1.0), state.strain)?;
            (FileBox { periodic: [true, true, false], ..cell }, parameters.time_step)
        }
        _ => return Err("its run is neither of a suspension nor of disks".to_owned()),
    };
    let step = state.step;
    Ok(StartFile {
        positions: positions.into_vec(),
        radii: Some(state.particles.radii),
        species: Some(recorded(state.particles.species, scene)),
        ids: Some(state.particles.ids),
        cell: Some(cell),
        frame: TakenFrame { number: 0, count: 1, step: Some(step as i64), time: Some(step as f64 * time_step) },
        images: None,
        orientations,
    })
}

/// Species of a run by number, with the names in its scene.
pub(super) fn recorded(numbers: Vec<u32>, scene: &Scene) -> SpeciesColumn {
    let Kind::Suspension(scene) = scene.kind() else { return SpeciesColumn::Indices(numbers) };
    let names = scene.model.species.iter().map(|species| species.name.clone()).collect();
    SpeciesColumn::Recorded { numbers, names }
}

fn sheared(edges: Vector, strain: f64) -> Result<FileBox, String> {
    PeriodicBox::sheared(edges, strain).map(|cell| FileBox::of_cell(&cell)).map_err(|e| e.to_string())
}
