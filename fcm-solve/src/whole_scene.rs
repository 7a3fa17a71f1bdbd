//! Scenes that are carried out as a whole.

use crate::preparing::Preparing;
use crate::streams;
use domain::Comm;
use io::{Listener, RunFolder, Scene, WholeScene};
use std::process::ExitCode;
use std::sync::Mutex;

/// Shows how far the work is.
struct Shown(Mutex<Preparing>);

impl Listener for Shown {
    fn line(&self, text: &str) {
        self.0.lock().expect("nobody who holds it panics").say(text);
    }

    fn part(&self, part: f64) {
        self.0.lock().expect("nobody who holds it panics").show(part);
    }
}

/// Does what is left to do of a scene without steps. A signal ends the program at once: what was done is kept.
pub fn carry_out(work: &WholeScene, (scene, folder): (&Scene, &RunFolder), comm: &Comm) -> anyhow::Result<ExitCode> {
    let shown = Shown(Mutex::new(Preparing::start(comm, "all runs")));
    let done = work.carry_out(scene, folder, comm, &shown);
    drop(shown);
    streams::log(format_args!("finished; results in {}", folder.path().display()));
    Ok(done.map(|()| ExitCode::SUCCESS)?)
}
