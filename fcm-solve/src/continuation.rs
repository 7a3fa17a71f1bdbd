//! Continuing runs from a checkpoint.

use crate::run_loop::run_to_end;
use crate::scene_file::read;
use crate::signals::Signals;
use crate::streams;
use anyhow::Context;
use domain::Comm;
use run::{Resumption, RunFolder};
use scene::Scene;
use std::process::ExitCode;

/// Continues a run to the end of its scene, and logs damaged checkpoints and changed keys. Collective.
pub fn continue_run(mut resumption: Resumption, comm: &Comm, signals: &Signals) -> anyhow::Result<ExitCode> {
    for damaged in resumption.damaged().iter().filter(|_| comm.is_first()) {
        streams::log(format_args!("warning: {damaged}"));
    }
    let notes = resumption.notes().to_vec();
    let name = resumption.folder().path().display().to_string();
    let mut resumed =
        resumption.simulation(comm).with_context(|| format!("{name}: the last checkpoint does not fit its scene"))?;
    let (mut recorder, scene) = resumption.record(&mut *resumed)?;
    for note in notes.iter().filter(|_| comm.is_first()) {
        streams::log(note);
    }
    run_to_end(&mut *resumed, &mut recorder, scene.kind().steps(), signals)
}

/// The scene of a folder, with `steps` as its last step if given. Collective.
pub fn kept_scene(folder: &RunFolder, steps: Option<u64>, comm: &Comm) -> anyhow::Result<Scene> {
    let overrides: Vec<String> = steps.iter().map(|n| format!("time.steps={n}")).collect();
    read(&folder.scene(), &overrides, comm)
}
