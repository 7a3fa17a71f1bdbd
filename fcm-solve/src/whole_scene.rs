//! Carrying out scenes without time steps.

use crate::part_progress::PartProgress;
use crate::streams;
use domain::Comm;
use io::{Listener, RunFolder, Scene, WholeScene};
use std::process::ExitCode;
use std::sync::Mutex;

/// Shows messages and progress.
struct Shown(Mutex<PartProgress>);

impl Listener for Shown {
    fn line(&self, text: &str) {
        self.0.lock().expect("nobody who holds it panics").say(text);
    }

    fn part(&self, part: f64) {
        self.0.lock().expect("nobody who holds it panics").show(part);
    }
}

/// Does the work that is left of a scene without time steps. A signal ends the program at once; finished results are
/// kept.
pub fn carry_out(work: &WholeScene, (scene, folder): (&Scene, &RunFolder), comm: &Comm) -> anyhow::Result<ExitCode> {
    let shown = Shown(Mutex::new(PartProgress::start(comm, "all runs")));
    let done = work.carry_out(scene, folder, comm, &shown);
    drop(shown);
    streams::log(format_args!("finished; results in {}", folder.path().display()));
    Ok(done.map(|()| ExitCode::SUCCESS)?)
}
