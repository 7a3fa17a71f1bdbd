//! `fcm-solve resume`: continues a run from its last checkpoint.

use crate::causes::in_full;
use crate::commands::resume_command;
use crate::continuation::{continue_run, kept_scene};
use crate::family::{self, FamilyTask, Part};
use crate::scene_file::read_any;
use crate::signals::{Signals, StopArgs};
use crate::whole_scene::carry_out;
use anyhow::{bail, ensure};
use domain::Comm;
use run::{ExistingRun, FamilyFolder, Resumption, RunFolder, WholeScene};
use scene::SceneFile;
use std::path::PathBuf;
use std::process::ExitCode;

/// Run to continue, and its new end.
#[derive(clap::Args)]
pub struct ResumeArgs {
    /// The folder of the run, or of a family
    folder: PathBuf,
    /// Go on until this step instead of the scene's last
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    steps: Option<u64>,
    /// Go on with another value of this key, fluid.viscosity or one of the section repulsion; may be repeated
    #[arg(long, value_name = "KEY")]
    accept: Vec<String>,
    #[command(flatten)]
    stops: StopArgs,
}

/// Continues the run. Collective.
pub fn run(args: &ResumeArgs, comm: &Comm) -> anyhow::Result<ExitCode> {
    let command = resume_command(&args.folder, args.steps);
    let signals = comm.agree(Signals::watch(comm, command, &args.stops))?;
    comm.agree(scene::check_accepted(&args.accept))?;
    if comm.any(comm.is_first() && FamilyFolder::holds_family(&args.folder)) {
        return resume_family(args, comm, &signals);
    }
    let folder = comm.agree(RunFolder::reopen(&args.folder, comm).map_err(|e| in_full(&e.into())))?;
    let scene = kept_scene(&folder, args.steps, comm)?;
    if let Some(work) = WholeScene::of(&scene) {
        run::check_ranks(scene.kind(), comm.size())?;
        run::check_memory(scene.kind(), comm)?;
        return carry_out(&work, &scene, &folder, comm);
    }
    let resumption = Resumption::of(folder, scene, &args.accept, comm)?;
    if let Some(last) = args.steps.filter(|last| *last < resumption.step()) {
        bail!("--steps is {last}, and the run has reached step {}; name a later step", resumption.step());
    }
    continue_run(resumption, comm, &signals)
}

/// Makes the missing members of a family. Collective.
fn resume_family(args: &ResumeArgs, comm: &Comm, signals: &Signals) -> anyhow::Result<ExitCode> {
    ensure!(args.steps.is_none(), "--steps goes with single runs; change the end in the scene of the family");
    match read_any(&args.folder.join("scene.toml"), &[], comm)? {
        SceneFile::Family(family) => {
            let work = FamilyTask { family: &family, part: Part::WHOLE, accepted: &args.accept };
            family::run(&work, &args.folder, ExistingRun::Continue, signals)
        }
        SceneFile::Scene(_) => bail!("{} holds no family any more", args.folder.display()),
    }
}
