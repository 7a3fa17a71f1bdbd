//! `fcm-solve info`: the contents of a result file.

use crate::causes::in_full;
use crate::streams::{self, json};
use anyhow::{anyhow, ensure};
use domain::Comm;
use io::Contents;
use std::path::{Path, PathBuf};

/// Which file.
#[derive(clap::Args)]
pub struct Args {
    /// An HDF5 file of a run
    file: PathBuf,
    /// Print the scene that the file comes from
    #[arg(long, conflicts_with = "json")]
    scene: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Describes the file.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<()> {
    let contents = if comm.is_first() { read(&args.file).map(Some) } else { Ok(None) };
    let contents = comm.agree(contents.map_err(|e| in_full(&e)))?;
    let text = |contents: &Contents| match (args.scene, args.json) {
        (true, _) => contents.scene(),
        (_, true) => json(&serde_json::json!(contents)),
        _ => contents.to_string(),
    };
    streams::print(comm, &contents.as_ref().map(text).unwrap_or_default())?;
    let damage = contents.map(|contents| contents.damage.join("; ")).unwrap_or_default();
    ensure!(
        damage.is_empty(),
        "{} is damaged: {damage}; restore it from a copy, or go on without that: stats leaves damaged frames out",
        args.file.display()
    );
    Ok(())
}

fn read(path: &Path) -> anyhow::Result<Contents> {
    let is_scene = path.is_file() && path.extension().is_some_and(|extension| extension == "toml");
    Contents::read(path).map_err(|error| match (is_scene, path.display()) {
        (true, name) => {
            anyhow!("{name} is a scene, not a file of results; to see what it computes: fcm-solve check {name}")
        }
        (false, _) => error.into(),
    })
}
