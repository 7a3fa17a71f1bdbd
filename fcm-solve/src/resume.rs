//! `fcm-solve resume`: a run from its last checkpoint.

use crate::march::march;
use crate::output::{Folder, Recorder};
use crate::run::{Whole, in_full, quoted, read};
use crate::signals::Signals;
use crate::walltime::{self, Walltime};
use crate::{granular, simulation, streams};
use anyhow::Context;
use domain::Comm;
use io::{Checkpoint, Scene};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Which run to go on with.
#[derive(clap::Args)]
pub struct Args {
    /// The folder of the run
    folder: PathBuf,
    /// Go on until this step instead of the scene's last
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    steps: Option<u64>,
    /// Stop in time before so long has passed, as 23:50:00 or 1-12:00:00 [default: the end of the job, if Slurm says]
    #[arg(long, value_name = "TIME", value_parser = walltime::parse)]
    walltime: Option<Walltime>,
}

/// Goes on with the run. Collective.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<ExitCode> {
    let command = resume_command(&args.folder, args.steps);
    let signals = comm.agree(Signals::watch(comm, command, walltime::end(args.walltime)))?;
    let folder = comm.agree(Folder::reopen(&args.folder, comm).map_err(|e| in_full(&e)))?;
    let scene = kept_scene(&folder, args.steps, comm)?;
    if let Some(work) = Whole::of(&scene) {
        granular::on_one_rank(comm)?;
        granular::check_room(scene.kind(), comm)?;
        return work.carry_out(&scene, &folder, comm);
    }
    let checkpoint = comm.agree(latest(&folder, comm))?;
    go_on(folder, checkpoint, args.steps, (comm, &signals))
}

/// Goes on from a checkpoint, which the first rank brings, until step `steps` if that is not the end of the scene in
/// the folder. Collective.
pub fn go_on(
    folder: Folder,
    checkpoint: Option<Checkpoint>,
    steps: Option<u64>,
    (comm, signals): (&Comm, &Signals),
) -> anyhow::Result<ExitCode> {
    let scene = kept_scene(&folder, steps, comm)?;
    if steps.is_some() {
        let kept = if comm.is_first() { folder.keep(scene.text()) } else { Ok(()) };
        comm.agree(kept.map_err(|e| in_full(&e)))?;
    }
    let mut resumed = simulation::resume(&scene, checkpoint, comm)
        .with_context(|| format!("{}: the last checkpoint does not fit its scene", folder.path().display()))?;
    let mut recorder = Recorder::resume(folder, &scene, &mut *resumed)?;
    march(&mut *resumed, &mut recorder, scene.kind().steps(), signals)
}

/// The scene of a folder, perhaps with another end. Collective.
fn kept_scene(folder: &Folder, steps: Option<u64>, comm: &Comm) -> anyhow::Result<Scene> {
    let overrides: Vec<String> = steps.iter().map(|n| format!("time.steps={n}")).collect();
    read(&folder.scene(), &overrides, comm)
}

/// The last whole checkpoint, on the first rank.
pub fn latest(folder: &Folder, comm: &Comm) -> Result<Option<Checkpoint>, io::FileError> {
    if !comm.is_first() {
        return Ok(None);
    }
    let (checkpoint, damaged) = Checkpoint::latest(folder.path())?;
    for error in damaged {
        streams::log(format_args!("warning: {error}; going on from the checkpoint before, step {}", checkpoint.step));
    }
    Ok(Some(checkpoint))
}

/// The command that goes on with the run of a folder.
pub fn resume_command(folder: &Path, steps: Option<u64>) -> String {
    let folder = quoted(&folder.display().to_string());
    let steps = steps.map_or_else(String::new, |steps| format!(" --steps {steps}"));
    format!("fcm-solve resume {folder}{steps}")
}
