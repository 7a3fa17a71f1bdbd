//! Continuing runs from a checkpoint.

use crate::causes::in_full;
use crate::run_loop::run_to_end;
use crate::scene_file::read;
use crate::signals::Signals;
use crate::streams;
use anyhow::Context;
use domain::{Comm, Failure};
use io::{Checkpoints, Recorder, RunFolder, Scene};
use simulation::State;
use std::process::ExitCode;

/// Continues from a checkpoint, of which each rank passes its share, to the scene's end or to step `steps`. Collective.
pub fn go_on(
    folder: RunFolder,
    state: Option<State>,
    steps: Option<u64>,
    (comm, signals): (&Comm, &Signals),
) -> anyhow::Result<ExitCode> {
    let scene = kept_scene(&folder, steps, comm)?;
    if steps.is_some() {
        let kept = if comm.is_first() { folder.keep(scene.text()) } else { Ok(()) };
        comm.agree(kept.map_err(|e| in_full(&e.into())))?;
    }
    let mut resumed = io::resume(&scene, state, comm)
        .with_context(|| format!("{}: the last checkpoint does not fit its scene", folder.path().display()))?;
    let mut recorder = Recorder::resume(folder, &scene, &mut *resumed)?;
    run_to_end(&mut *resumed, &mut recorder, scene.kind().steps(), signals)
}

/// The scene of a folder, perhaps with another end. Collective.
pub fn kept_scene(folder: &RunFolder, steps: Option<u64>, comm: &Comm) -> anyhow::Result<Scene> {
    let overrides: Vec<String> = steps.iter().map(|n| format!("time.steps={n}")).collect();
    read(&folder.scene(), &overrides, comm)
}

/// The state of the last whole checkpoint, on each rank with a share of the particles. Collective.
pub fn latest(folder: &RunFolder, comm: &Comm) -> Result<Option<State>, Failure> {
    let (state, damaged) = Checkpoints::of(folder.path()).latest(comm)?;
    for error in damaged {
        streams::log(format_args!("warning: {error}; going on from the checkpoint before, step {}", state.step));
    }
    Ok(Some(state))
}
