//! `fcm-solve run`: a scene from its start.

use crate::march::march;
use crate::output::{Folder, Recorder};
use crate::suspension::Suspension;
use anyhow::Context;
use domain::Comm;
use io::{Kind, Scene};
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
    let scene = read(&args.scene, &args.overrides, comm)?;
    let Kind::Suspension(suspension) = scene.kind() else {
        anyhow::bail!("this version of the program can't run scenes of this kind");
    };
    let folder = args.out.clone().or_else(|| suspension.output.folder.clone());
    let folder = folder.unwrap_or_else(|| default_folder(&args.scene));
    let folder = comm.agree(Folder::claim(&folder, comm, args.force).map_err(|e| in_full(&e)))?;
    let mut started = Suspension::start(suspension, comm)?;
    let mut recorder = Recorder::create(folder, &scene, &mut started)?;
    march(&mut started, &mut recorder, suspension.time.steps)
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
    let text = text.map_err(|source| io::SceneError::Unreadable { name: name.to_owned(), source })?;
    Scene::parse(&text, name, overrides)
}

/// An error with all its causes, for the other ranks.
pub fn in_full(error: &anyhow::Error) -> String {
    format!("{error:#}")
}

fn default_folder(scene: &Path) -> PathBuf {
    Path::new("results").join(scene.file_stem().unwrap_or(scene.as_os_str()))
}
