//! `fcm-solve run`: runs a scene from its start, or continues a run of it.

use crate::causes::in_full;
use crate::commands::{quoted, resume_command};
use crate::continuation::continue_run;
use crate::family::{self, FamilyTask, Part};
use crate::part_progress::PartProgress;
use crate::prepared_scene::{PreparedScene, prepared};
use crate::run_loop::run_to_end;
use crate::scene_file::{read, read_any};
use crate::signals::{Signals, StopArgs};
use crate::streams;
use crate::whole_scene::carry_out;
use anyhow::ensure;
use domain::Comm;
use files::Checkpoints;
use run::{ExistingRun, Recorder, Resumption, RunFolder, WholeScene};
use scene::{Difference, Family, Scene, SceneFile, some_of};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Scene to run, and the folder of its results.
#[derive(clap::Args)]
pub struct RunArgs {
    /// The scene file; - reads it from the standard input
    scene: PathBuf,
    /// Folder of the results [default: the scene's output.folder, or results/ and the scene's name]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Set a key of the scene, as in --set time.step=0.01 or --set `species[0].count=10`; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Replace the results of an earlier run in that folder
    #[arg(long)]
    force: bool,
    /// Go on with the run in that folder, if there is one and it is not finished
    #[arg(long = "continue", conflicts_with = "force")]
    goes_on: bool,
    /// Go on with another value of this key, fluid.viscosity or one of the section repulsion; may be repeated
    #[arg(long, value_name = "KEY", requires = "goes_on")]
    accept: Vec<String>,
    /// Make part K of N of a family's runs, while other programs make the other parts in the same folder
    #[arg(long, value_name = "K/N", conflicts_with = "force", allow_hyphen_values = true)]
    part: Option<Part>,
    #[command(flatten)]
    stops: StopArgs,
}

/// Runs the scene, or the members of a family. Collective.
pub fn run(args: &RunArgs, comm: &Comm) -> anyhow::Result<ExitCode> {
    let scene = match read_any(&args.scene, &args.overrides, comm)? {
        SceneFile::Scene(scene) => *scene,
        SceneFile::Family(family) => return run_family(args, &family, comm),
    };
    run::check_ranks(scene.kind(), comm.size())?;
    comm.agree(scene::check_accepted(&args.accept))?;
    ensure!(args.part.is_none(), "--part goes with families, scenes with [ensemble] or [sweep]; leave it out");
    let path = args.folder(scene.kind().folder());
    let signals = Signals::watch(comm, args.command(&path), &args.stops);
    let signals = comm.agree(signals)?;
    let folder = comm.agree(RunFolder::claim(&path, comm, args.former()).map_err(|e| in_full(&e.into())))?;
    if args.goes_on && folder.holds_run(comm) {
        return start_or_go_on(scene, folder, &args.accept, comm, &signals);
    }
    start(scene, folder, comm, &signals)
}

/// Makes the missing members of a family.
fn run_family(args: &RunArgs, family: &Family, comm: &Comm) -> anyhow::Result<ExitCode> {
    scene::check_accepted(&args.accept).map_err(anyhow::Error::msg)?;
    let path = args.folder(family.output_folder().as_deref());
    let signals = Signals::watch(comm, args.command(&path), &args.stops)?;
    let work = FamilyTask { family, part: args.part.unwrap_or(Part::WHOLE), accepted: &args.accept };
    // Programs for other parts may have made the folder already.
    let former = if args.part.is_some() { ExistingRun::Continue } else { args.former() };
    family::run(&work, &path, former, &signals)
}

/// Starts a run from the beginning. Collective.
fn start(scene: Scene, mut folder: RunFolder, comm: &Comm, signals: &Signals) -> anyhow::Result<ExitCode> {
    let PreparedScene { scene, notes } = prepared(scene, true, comm)?;
    for (label, note) in notes {
        streams::inform(format_args!("{label:<10} {note}"));
    }
    if let Some(work) = WholeScene::of(&scene) {
        run::check_memory(scene.kind(), comm)?;
        folder.start_with(scene.text())?;
        signals.go_on_with(resume_command(folder.path(), None));
        return carry_out(&work, &scene, &folder, comm);
    }
    let mut preparing = PartProgress::start(comm, "the particles are placed");
    let mut started = run::start(&scene, comm, &mut |part| preparing.show(part))?;
    drop(preparing);
    let mut recorder = Recorder::create(folder, &scene, &mut *started)?;
    run_to_end(&mut *started, &mut recorder, scene.kind().steps(), signals)
}

/// Continues the run in a folder to the present end of the scene, or starts it. Collective.
fn start_or_go_on(
    scene: Scene,
    folder: RunFolder,
    accepted: &[String],
    comm: &Comm,
    signals: &Signals,
) -> anyhow::Result<ExitCode> {
    let kept = read(&folder.scene(), &[], comm)?;
    if let Some(work) = WholeScene::of(&kept) {
        let differences = scene.differences(&kept).into_iter();
        refuse_another(differences.filter(|d| !["title", "output.folder"].contains(&d.key.as_str())), folder.path())?;
        return if comm.any(comm.is_first() && work.is_finished(folder.path())) {
            Ok(finished("", &folder, comm))
        } else {
            signals.go_on_with(resume_command(folder.path(), None));
            carry_out(&work, &kept, &folder, comm)
        };
    }
    refuse_another(scene.fixed_differences(&kept).into_iter(), folder.path())?;
    let has_checkpoint = if comm.is_first() { Checkpoints::of(folder.path()).any() } else { Ok(false) };
    if !comm.any(comm.agree(has_checkpoint)?) {
        return start(scene, folder, comm, signals);
    }
    let end = scene.kind().steps();
    let with_own_keys = scene.with_own_keys_of(&kept)?;
    let now = if with_own_keys.differences(&kept).is_empty() { kept } else { with_own_keys };
    let resumption = Resumption::of(folder, now, accepted, comm)?;
    if resumption.step() >= end {
        return Ok(finished(&format!(", after step {end}"), resumption.folder(), comm));
    }
    continue_run(resumption, comm, signals)
}

fn finished(when: &str, folder: &RunFolder, comm: &Comm) -> ExitCode {
    if comm.is_first() {
        streams::inform(format_args!("finished already{when}; results in {}", folder.path().display()));
    }
    ExitCode::SUCCESS
}

/// Refuses to continue the run of another scene, given the keys in which it differs.
fn refuse_another(differences: impl Iterator<Item = Difference>, folder: &Path) -> anyhow::Result<()> {
    let lines: Vec<String> = differences.map(|difference| difference.to_string()).collect();
    ensure!(
        lines.is_empty(),
        "{} holds the run of another scene: {}; name another folder with --out, or replace that run with --force",
        folder.display(),
        some_of(&lines)
    );
    Ok(())
}

impl RunArgs {
    fn folder(&self, of_scene: Option<&Path>) -> PathBuf {
        let named = self.out.clone().or_else(|| of_scene.map(Path::to_owned));
        named.unwrap_or_else(|| default_folder(&self.scene))
    }

    fn former(&self) -> ExistingRun {
        match (self.force, self.goes_on) {
            (true, _) => ExistingRun::Replace,
            (_, true) => ExistingRun::Continue,
            _ => ExistingRun::Keep,
        }
    }

    /// Command line that starts this run again, or continues it.
    fn command(&self, folder: &Path) -> String {
        let how = if self.force { "force" } else { "continue" };
        let part = self.part.map_or_else(String::new, |part| format!(" --part {part}"));
        let accepts: String = self.accept.iter().fold(String::new(), |all, key| all + " --accept " + &quoted(key));
        let sets: String = self.overrides.iter().fold(String::new(), |sets, set| sets + " --set " + &quoted(set));
        let [scene, folder] = [&self.scene, folder].map(|path| quoted(&path.display().to_string()));
        format!("fcm-solve run {scene} --out {folder}{sets}{accepts}{part} --{how}")
    }
}

fn default_folder(scene: &Path) -> PathBuf {
    Path::new("results").join(scene.file_stem().unwrap_or(scene.as_os_str()))
}
