//! `fcm-solve run`: runs a scene from its start, or continues a run of it.

use crate::causes::in_full;
use crate::commands::{quoted, resume_command};
use crate::continuation::{go_on, latest};
use crate::part_progress::PartProgress;
use crate::run_loop::run_to_end;
use crate::scene_file::read;
use crate::signals::{Signals, StopArgs};
use crate::whole_scene::carry_out;
use crate::{prepared_scene::prepared, streams};
use anyhow::ensure;
use domain::Comm;
use io::{Checkpoints, ExistingRun, Kind, Recorder, RunFolder, Scene, WholeScene};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What to run, and where the results go.
#[derive(clap::Args)]
pub struct Args {
    /// The scene file; - reads it from the standard input
    scene: PathBuf,
    /// Folder of the results [default: the scene's output.folder, or results/ and the scene's name]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Set a key of the scene, as in --set time.step=0.01 or --set `species[0].count=10`; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Replace the results of a former run in that folder
    #[arg(long)]
    force: bool,
    /// Go on with the run in that folder, if there is one and it is not finished
    #[arg(long = "continue", conflicts_with = "force")]
    goes_on: bool,
    #[command(flatten)]
    stops: StopArgs,
}

/// Runs the scene. Collective.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<ExitCode> {
    let scene = read(&args.scene, &args.overrides, comm)?;
    let path = args.folder(&scene);
    let signals = Signals::watch(comm, args.command(&path), &args.stops);
    let signals = comm.agree(signals)?;
    let folder = comm.agree(RunFolder::claim(&path, comm, args.former()).map_err(|e| in_full(&e.into())))?;
    if args.goes_on && folder.holds_run(comm) {
        return start_or_go_on(scene, folder, comm, &signals);
    }
    start(scene, folder, comm, &signals)
}

/// A run from its start. Collective.
fn start(scene: Scene, mut folder: RunFolder, comm: &Comm, signals: &Signals) -> anyhow::Result<ExitCode> {
    let scene = prepared(scene, comm)?;
    if let Some(work) = WholeScene::of(&scene) {
        io::check_memory(scene.kind(), comm)?;
        folder.start_with(scene.text())?;
        signals.go_on_with(resume_command(folder.path(), None));
        return carry_out(&work, (&scene, &folder), (comm, signals));
    }
    let mut preparing = PartProgress::start(comm, "the particles are placed");
    let mut started = io::start(&scene, comm, &mut |part| preparing.show(part))?;
    drop(preparing);
    let mut recorder = Recorder::create(folder, &scene, &mut *started)?;
    run_to_end(&mut *started, &mut recorder, scene.kind().steps(), signals)
}

/// Continues the run in a folder to the present end of the scene, or starts it. Collective.
fn start_or_go_on(scene: Scene, folder: RunFolder, comm: &Comm, signals: &Signals) -> anyhow::Result<ExitCode> {
    let kept = read(&folder.scene(), &[], comm)?;
    refuse_another(&scene, &kept, folder.path())?;
    let end = scene.kind().steps();
    if let Some(work) = WholeScene::of(&kept) {
        return if comm.any(comm.is_first() && work.is_finished(folder.path())) {
            Ok(finished("", &folder, comm))
        } else {
            signals.go_on_with(resume_command(folder.path(), None));
            carry_out(&work, (&kept, &folder), (comm, signals))
        };
    }
    let has_checkpoint = if comm.is_first() { Checkpoints::of(folder.path()).any() } else { Ok(false) };
    if !comm.any(comm.agree(has_checkpoint)?) {
        return start(scene, folder, comm, signals);
    }
    let state = comm.agree(latest(&folder, comm))?;
    if comm.any(state.as_ref().is_some_and(|state| state.step >= end)) {
        return Ok(finished(&format!(", after step {end}"), &folder, comm));
    }
    let other_end = (end != kept.kind().steps()).then_some(end);
    go_on(folder, state, other_end, (comm, signals))
}

fn finished(when: &str, folder: &RunFolder, comm: &Comm) -> ExitCode {
    if comm.is_first() {
        streams::log(format_args!("finished already{when}; results in {}", folder.path().display()));
    }
    ExitCode::SUCCESS
}

/// Refuses to continue the run of another scene. The end may differ, since it only says how far the run goes.
fn refuse_another(scene: &Scene, kept: &Scene, folder: &Path) -> anyhow::Result<()> {
    let says = |key: &str| scene.differences(kept).iter().any(|d| d.key.starts_with(key) && d.values[0].is_some());
    let calibrates = matches!(scene.kind(), Kind::Suspension(s) if s.model.repulsion.is_some_and(|r| r.calibrate));
    let may_differ = |key: &str| {
        ["time.steps", "time.duration", "time.strain", "output.folder"].contains(&key)
            || [COSTS, STIFFNESS, STRAIN].iter().any(|added| key.starts_with(added) && !says(added))
            || calibrates && ["repulsion.strength", "repulsion.calibrate"].contains(&key)
    };
    let differences = scene.differences(kept).into_iter().filter(|d| !may_differ(&d.key));
    let lines: Vec<String> = differences.map(|d| d.to_string()).collect();
    ensure!(
        lines.is_empty(),
        "{} holds the run of another scene: {}{}; name another folder with --out, or replace that run with --force",
        folder.display(),
        lines[..lines.len().min(NAMED)].join(", "),
        if lines.len() > NAMED { format!(", and {} more", lines.len() - NAMED) } else { String::new() }
    );
    Ok(())
}

/// The key that a run adds to its scene: the measured costs of the machine where it started.
const COSTS: &str = "hydrodynamics.costs";
/// Another one: what the stiffness of contacts has settled at.
const STIFFNESS: &str = "contacts.settled_stiffness";
/// And another: the strain of the box that its particles come from.
const STRAIN: &str = "box.strain";
/// Differences that are named.
const NAMED: usize = 5;

impl Args {
    fn folder(&self, scene: &Scene) -> PathBuf {
        let named = self.out.clone().or_else(|| scene.kind().folder().map(Path::to_owned));
        named.unwrap_or_else(|| default_folder(&self.scene))
    }

    fn former(&self) -> ExistingRun {
        match (self.force, self.goes_on) {
            (true, _) => ExistingRun::Replace,
            (_, true) => ExistingRun::Continue,
            _ => ExistingRun::Keep,
        }
    }

    /// The command that starts this run again, or continues it.
    fn command(&self, folder: &Path) -> String {
        let how = if self.force { "force" } else { "continue" };
        let sets: String = self.overrides.iter().fold(String::new(), |sets, set| sets + " --set " + &quoted(set));
        let [scene, folder] = [&self.scene, folder].map(|path| quoted(&path.display().to_string()));
        format!("fcm-solve run {scene} --out {folder}{sets} --{how}")
    }
}

fn default_folder(scene: &Path) -> PathBuf {
    Path::new("results").join(scene.file_stem().unwrap_or(scene.as_os_str()))
}
