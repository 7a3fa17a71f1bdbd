//! `fcm-solve resume`: a run from its last checkpoint.

use crate::march::march;
use crate::output::{Folder, Recorder};
use crate::run::{Whole, in_full, read};
use crate::{granular, simulation};
use domain::Comm;
use io::Checkpoint;
use std::path::PathBuf;
use std::process::ExitCode;

/// Which run to go on with.
#[derive(clap::Args)]
pub struct Args {
    /// The folder of the run
    folder: PathBuf,
    /// Go on until this step instead of the scene's last
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    steps: Option<u64>,
}

/// Goes on with the run. Collective.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<ExitCode> {
    let folder = comm.agree(Folder::reopen(&args.folder, comm).map_err(|e| in_full(&e)))?;
    let overrides: Vec<String> = args.steps.iter().map(|n| format!("time.steps={n}")).collect();
    let scene = read(&folder.scene(), &overrides, comm)?;
    if let Some(work) = Whole::of(&scene) {
        granular::on_one_rank(comm)?;
        return work.carry_out(&scene, &folder, comm);
    }
    let checkpoint = comm.agree(latest(&folder, comm))?;
    if args.steps.is_some() {
        let kept = if comm.is_first() { folder.keep(scene.text()) } else { Ok(()) };
        comm.agree(kept.map_err(|e| in_full(&e)))?;
    }
    let mut resumed = simulation::resume(&scene, checkpoint, comm)?;
    let mut recorder = Recorder::resume(folder, &scene, &mut *resumed)?;
    march(&mut *resumed, &mut recorder, scene.kind().steps())
}

/// The last whole checkpoint, on the first rank.
fn latest(folder: &Folder, comm: &Comm) -> Result<Option<Checkpoint>, io::FileError> {
    if !comm.is_first() {
        return Ok(None);
    }
    let (checkpoint, damaged) = Checkpoint::latest(folder.path())?;
    for error in damaged {
        eprintln!("warning: {error}; going on from the checkpoint before, step {}", checkpoint.step);
    }
    Ok(Some(checkpoint))
}
