//! Carrying out scenes without time steps.

use crate::part_progress::PartProgress;
use crate::signals::Signals;
use crate::streams;
use domain::Comm;
use io::{Listener, RunFolder, Scene, WholeScene};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

/// Shows messages and progress.
struct Shown {
    progress: Mutex<PartProgress>,
    stored: Arc<AtomicU64>,
}

impl Listener for Shown {
    fn line(&self, text: &str) {
        self.progress.lock().expect("nobody who holds it panics").say(text);
    }

    fn part(&self, part: f64) {
        self.progress.lock().expect("nobody who holds it panics").show(part);
    }

    fn stored(&self) {
        self.stored.fetch_add(1, Ordering::SeqCst);
    }
}

/// Does the work that is left of a scene without time steps. A signal ends the program at once; finished results are
/// kept.
pub fn carry_out(
    work: &WholeScene,
    (scene, folder): (&Scene, &RunFolder),
    (comm, signals): (&Comm, &Signals),
) -> anyhow::Result<ExitCode> {
    let progress = Mutex::new(PartProgress::start(comm, "all runs"));
    let shown = Shown { progress, stored: signals.stored_results() };
    let done = work.carry_out(scene, folder, comm, &shown);
    drop(shown);
    streams::inform(format_args!("finished; results in {}", folder.path().display()));
    Ok(done.map(|()| ExitCode::SUCCESS)?)
}
