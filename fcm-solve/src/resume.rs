//! `fcm-solve resume`: a run from its last checkpoint.

use crate::march::march;
use crate::output::{Folder, Recorder};
use crate::run::{in_full, read};
use crate::suspension::Suspension;
use domain::Comm;
use io::{Checkpoint, Kind};
use std::path::PathBuf;
use std::process::ExitCode;

/// Which run to go on with.
#[derive(clap::Args)]
pub struct Args {
    /// The folder of the run
    folder: PathBuf,
    /// Go on until this step instead of the scene's last
    #[arg(long, value_name = "N")]
    steps: Option<u64>,
}

/// Goes on with the run. Collective.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<ExitCode> {
    let folder = comm.agree(Folder::reopen(&args.folder, comm).map_err(|e| in_full(&e)))?;
    let overrides: Vec<String> = args.steps.iter().map(|n| format!("time.steps={n}")).collect();
    let scene = read(&folder.scene(), &overrides, comm)?;
    let Kind::Suspension(suspension) = scene.kind() else {
        anyhow::bail!("this version of the program can't run scenes of this kind");
    };
    let mut checkpoint = comm.agree(latest(&folder, comm))?;
    let statistics = checkpoint.as_mut().map(|c| std::mem::take(&mut c.statistics)).unwrap_or_default();
    if args.steps.is_some() {
        let kept = if comm.is_first() { folder.keep(scene.text()) } else { Ok(()) };
        comm.agree(kept.map_err(|e| in_full(&e)))?;
    }
    let mut resumed = Suspension::resume(suspension, checkpoint, comm)?;
    let mut recorder = Recorder::resume(folder, &scene, &mut resumed, &statistics)?;
    march(&mut resumed, &mut recorder, suspension.time.steps)
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
