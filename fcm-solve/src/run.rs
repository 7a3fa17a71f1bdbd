//! `fcm-solve run`: a scene from its start.

use crate::least_repulsion::with_least_repulsion;
use crate::machine::on_this_machine;
use crate::march::march;
use crate::output::{Folder, Recorder};
use crate::{granular, simulation};
use anyhow::Context;
use domain::Comm;
use drivers::disks::Sweep;
use io::{ContinuumScene, Kind, Scene};
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
}

/// Runs the scene. Collective.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<ExitCode> {
    let scene = on_this_machine(read(&args.scene, &args.overrides, comm)?, comm)?;
    let scene = with_least_repulsion(scene, comm)?;
    let folder = args.out.clone().or_else(|| scene.kind().folder().map(Path::to_owned));
    let folder = folder.unwrap_or_else(|| default_folder(&args.scene));
    let folder = comm.agree(Folder::claim(&folder, comm, args.force).map_err(|e| in_full(&e)))?;
    if let Some(work) = Whole::of(&scene) {
        granular::on_one_rank(comm)?;
        folder.start_with(scene.text())?;
        return work.carry_out(&scene, &folder, comm);
    }
    let mut started = simulation::start(&scene, comm)?;
    let mut recorder = Recorder::create(folder, &scene, &mut *started)?;
    march(&mut *started, &mut recorder, scene.kind().steps())
}

/// A scene that has no steps of its own to march through.
pub enum Whole<'a> {
    /// Problems to solve.
    Continuum(&'a ContinuumScene),
    /// Runs to make.
    Sweep(&'a Sweep),
}

impl<'a> Whole<'a> {
    /// The scene as one of these, if it is one.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        match scene.kind() {
            Kind::Continuum(scene) => Some(Self::Continuum(scene)),
            Kind::GranularDisks(scene) => scene.sweep.as_ref().map(Self::Sweep),
            _ => None,
        }
    }

    /// Does what is left to do.
    pub fn carry_out(&self, scene: &Scene, folder: &Folder, comm: &Comm) -> anyhow::Result<ExitCode> {
        match self {
            Self::Continuum(problems) => granular::solve(problems, scene, folder.path(), comm),
            Self::Sweep(runs) => granular::sweep(runs, scene, folder.path(), comm),
        }
    }
}

/// Reads a scene on the first rank and shares it. Collective.
pub fn read(path: &Path, overrides: &[String], comm: &Comm) -> anyhow::Result<Scene> {
    let read = if comm.is_first() { read_here(path, overrides).map(Some) } else { Ok(None) };
    let read = comm.agree(read)?;
    let text = comm.broadcast_text(read.as_ref().map_or("", |scene| scene.text()));
    read.map_or_else(|| Scene::parse(&text, &path.display().to_string(), &[]).context("as the first rank sent it"), Ok)
}

fn read_here(path: &Path, overrides: &[String]) -> Result<Scene, io::SceneError> {
    if path != Path::new("-") {
        return Scene::read(path, overrides);
    }
    let name = "standard input";
    let text = std::io::read_to_string(std::io::stdin());
    let text = text.map_err(|reason| io::SceneError::Unreadable { name: name.to_owned(), reason })?;
    Scene::parse(&text, name, overrides)
}

/// An error with all its causes, for the other ranks.
pub fn in_full(error: &anyhow::Error) -> String {
    format!("{error:#}")
}

fn default_folder(scene: &Path) -> PathBuf {
    Path::new("results").join(scene.file_stem().unwrap_or(scene.as_os_str()))
}
