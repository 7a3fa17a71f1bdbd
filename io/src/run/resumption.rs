//! Going on with a run: from its last whole checkpoint, with a scene of which some keys may have changed.

use super::{Recorder, RunError, RunFolder, start};
use crate::scene_history::SceneHistory;
use crate::{Checkpoints, Kind, Latest, Scene, SceneChange, SceneRecord};
use domain::Comm;
use simulation::{Simulation, State};

/// A run that can go on: its last whole checkpoint, and what has changed in its scene since.
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
    /// The run of a folder with a scene as it is now. Refuses keys that may not change, and those that have to be accepted and
    /// are not. Collective.
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
            notes.push(format!("the averages of [statistics] begin anew at step {step}"));
        }
        Ok(Self { folder, scene, step, state: Some(state), record, changes, damaged, notes })
    }

    /// The step of the checkpoint.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// The folder of the run.
    pub fn folder(&self) -> &RunFolder {
        &self.folder
    }

    /// The scene as it is now.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Checkpoints that are damaged, on the first rank.
    pub fn damaged(&self) -> &[String] {
        &self.damaged
    }

    /// The keys that have changed, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The simulation in the state of the checkpoint. Collective.
    pub fn simulation(&mut self, comm: &Comm) -> Result<Box<dyn Simulation>, RunError> {
        start::resume(&self.scene, self.state.take(), comm)
    }

    /// What records the simulation, and the scene. Collective.
    pub fn record(self, simulation: &mut dyn Simulation) -> Result<(Recorder, Scene), RunError> {
        let Self { folder, scene, record, changes, .. } = self;
        let mut recorder = Recorder::resume(folder, (&scene, record), simulation)?;
        if changes.iter().any(|change| changes_state(&change.key)) {
            recorder.renew_checkpoint(simulation)?;
        }
        Ok((recorder, scene))
    }
}

/// Whether averages so far and those to come can't be of one series.
fn begins_statistics_anew(scene: &Scene, changes: &[SceneChange]) -> bool {
    matches!(scene.kind(), Kind::Suspension(_)) && changes.iter().any(|change| is_of_statistics(&change.key))
}

fn is_of_statistics(key: &str) -> bool {
    key.starts_with("statistics")
}

/// Whether a checkpoint with the former value of a key is none to go on from once the new one was accepted.
fn changes_state(key: &str) -> bool {
    is_of_statistics(key) || key.starts_with("fluid.") || key.starts_with("repulsion.")
}

/// The scene of the files of a run whose checkpoints have none, as older versions wrote them. Collective.
fn of_files(folder: &RunFolder, comm: &Comm) -> Option<String> {
    let names = ["trajectory.h5", "observables.h5"];
    let read = || names.iter().find_map(|name| SceneHistory::of(&folder.path().join(name)));
    let found = comm.is_first().then(read).flatten().map_or(String::new(), |history| history.first);
    Some(comm.broadcast_text(&found)).filter(|text| !text.is_empty())
}
