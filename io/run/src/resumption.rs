//! Resuming a run from its last intact checkpoint, with a scene in which some keys may have changed.

use crate::recorder::SceneInForce;
use crate::{Recorder, RunError, RunFolder, start};
use domain::Comm;
use files::{Checkpoints, Latest, SceneHistory, SceneRecord};
use granular::GrainStartError;
use scene::{Kind, Scene, SceneChange};
use simulation::{Simulation, State};

/// A run that can be resumed: its last intact checkpoint, and the changes of its scene since then.
pub struct Resumption {
    folder: RunFolder,
    scene: Scene,
    step: u64,
    state: Option<State>,
    record: Option<SceneRecord>,
    changes: Vec<SceneChange>,
    damaged: Vec<String>,
    notes: Vec<String>,
}

impl Resumption {
    /// The run in a folder with the present scene. Refuses changes of fixed keys, and changes that must be
    /// accepted and are not. Collective.
    pub fn of(folder: RunFolder, scene: Scene, accepted: &[String], comm: &Comm) -> Result<Self, RunError> {
        let Latest { mut state, scene: record, damaged } = Checkpoints::of(folder.path()).latest(comm)?;
        let step = state.step;
        let going_on = |error| format!("{error}; going on from the checkpoint before, step {step}");
        let damaged = damaged.iter().map(going_on).collect();
        let then = match &record {
            Some(record) => Some(record.text().to_owned()),
            None => of_files(&folder, comm),
        };
        let changes = scene.changes_since(then.as_deref().unwrap_or(scene.text()), accepted, step);
        let changes = comm.agree(changes.map_err(|reason| {
            let folder = folder.path().display();
            format!("{folder}: the scene is not that of the run's checkpoint of step {step}: {reason}")
        }))?;
        let mut notes: Vec<String> = changes.iter().map(|change| format!("the scene has changed: {change}")).collect();
        if begins_statistics_anew(&scene, &changes) {
            state.statistics = Vec::new();
            notes.push(format!("the averages of [statistics] start afresh at step {step}"));
        }
        Ok(Self { folder, scene, step, state: Some(state), record, changes, damaged, notes })
    }

    /// Step of the checkpoint.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Folder of the run.
    pub fn folder(&self) -> &RunFolder {
        &self.folder
    }

    /// The present scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Messages about damaged checkpoints, on the first rank.
    pub fn damaged(&self) -> &[String] {
        &self.damaged
    }

    /// Messages about the keys that have changed.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The simulation in the state of the checkpoint. Collective.
    pub fn simulation(&mut self, comm: &Comm) -> Result<Box<dyn Simulation>, RunError> {
        start::resume(&self.scene, self.state.take(), comm).map_err(|error| match error {
            RunError::Grains(source @ (GrainStartError::Parameter(_) | GrainStartError::State)) => {
                RunError::Checkpoint { file: Checkpoints::of(self.folder.path()).path(self.step), source }
            }
            other => other,
        })
    }

    /// Recorder of the simulation, and the scene. Collective.
    pub fn record(self, simulation: &mut dyn Simulation) -> Result<(Recorder, Scene), RunError> {
        let Self { folder, scene, record, changes, .. } = self;
        let mut recorder = Recorder::resume(folder, SceneInForce { scene: &scene, former: record }, simulation)?;
        if changes.iter().any(|change| changes_state(&change.key)) {
            recorder.renew_checkpoint(simulation)?;
        }
        Ok((recorder, scene))
    }
}

/// Whether the averages so far cannot be continued with the new scene.
fn begins_statistics_anew(scene: &Scene, changes: &[SceneChange]) -> bool {
    matches!(scene.kind(), Kind::Suspension(_)) && changes.iter().any(|change| is_of_statistics(&change.key))
}

fn is_of_statistics(key: &str) -> bool {
    key.starts_with("statistics")
}

/// Whether checkpoints with the former value of a key must not be resumed from once the new value has been accepted.
fn changes_state(key: &str) -> bool {
    is_of_statistics(key) || key.starts_with("fluid.") || key.starts_with("repulsion.")
}

/// Scene according to the files of a run whose checkpoints have none, as in older versions. Collective.
fn of_files(folder: &RunFolder, comm: &Comm) -> Option<String> {
    let names = ["trajectory.h5", "observables.h5"];
    let read = || names.iter().find_map(|name| SceneHistory::of(&folder.path().join(name)));
    let found = comm.is_first().then(read).flatten().map_or(String::new(), |history| history.first);
    Some(comm.broadcast_text(&found)).filter(|text| !text.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ExistingRun;
    use std::error::Error;

    const CELL: &str = r#"
        kind = "shear-cell"
        collisions = "event-driven"
        [cell]
        length = 6.0
        height = 5.0
        width = 5.0
        speed = 1.0
        [grains]
        diameter = 1.0
        density = 1.0
        count = 9
        restitution = 0.9
        friction = 0.3
        [walls]
        restitution = 0.9
        friction = 0.3
        [time]
        step = 0.1
        steps = 2
    "#;

    #[test]
    fn a_state_that_makes_no_sense_is_refused_by_the_name_of_its_file() {
        let (place, comm) = (tempfile::tempdir().unwrap(), Comm::alone());
        let scene = Scene::parse(CELL, "cell.toml", &[]).unwrap();
        let mut folder = RunFolder::claim(place.path(), &comm, ExistingRun::Keep).unwrap();
        folder.start_with(scene.text()).unwrap();
        let mut state = start::start(&scene, &comm, &mut |_| {}).unwrap().state();
        state.particles.vectors("velocity")[3].y = f64::NAN;
        let record = SceneRecord::new(scene.text(), scene.kind().output().unwrap());
        Checkpoints::write(folder.manifest(), &state, &record, &comm).unwrap();
        let mut resumption = Resumption::of(folder, scene, &[], &comm).unwrap();
        let error = resumption.simulation(&comm).err().unwrap();
        let file = place.path().join("checkpoint-0000000000.bin");
        let advice = "move it away to go on from the one before, or start the run afresh";
        let said = format!("{}: the scene can't be continued from this checkpoint; {advice}", file.display());
        assert_eq!(error.to_string(), said);
        assert!(error.source().unwrap().to_string().starts_with("velocity is ["), "{error:?}");
    }
}
