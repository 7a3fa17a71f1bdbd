//! Carrying out scenes without time steps.

use crate::part_progress::PartProgress;
use crate::streams;
use domain::Comm;
use run::{Listener, RunFolder, WholeScene};
use scene::Scene;
use std::process::ExitCode;

/// Listener that shows messages together with the progress.
struct ShownProgress(PartProgress);

impl Listener for ShownProgress {
    fn line(&self, text: &str) {
        self.0.say(text);
    }
}

/// Does the work of a scene without time steps. A signal ends the program at once.
pub fn carry_out(work: &WholeScene, scene: &Scene, folder: &RunFolder, comm: &Comm) -> anyhow::Result<ExitCode> {
    let shown = ShownProgress(PartProgress::start_late(comm, "all problems"));
    work.carry_out(scene, folder, comm, &shown)?;
    drop(shown);
    streams::inform(format_args!("finished; results in {}", folder.path().display()));
    Ok(ExitCode::SUCCESS)
}
