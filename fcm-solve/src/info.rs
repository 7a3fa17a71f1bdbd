//! `fcm-solve info`: the contents of a result file, or of the folder of a run.

use crate::causes::in_full;
use crate::family;
use crate::streams::{self, json};
use anyhow::{Context, anyhow, ensure};
use domain::Comm;
use files::{Contents, FolderContents};
use run::FamilyFolder;
use std::path::{Path, PathBuf};

/// File or folder to describe, and the form of the output.
#[derive(clap::Args)]
pub struct InfoArgs {
    /// An HDF5 file of a run, or the folder of a run or a family
    #[arg(value_name = "FILE|DIR")]
    file: PathBuf,
    /// Print the scene that the file comes from
    #[arg(long, conflicts_with = "json")]
    scene: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Prints the description of the file or folder, and fails if it is damaged. Collective.
pub fn run(args: &InfoArgs, comm: &Comm) -> anyhow::Result<()> {
    let described = if comm.is_first() { describe(args) } else { Ok(Described::default()) };
    let described = comm.agree(described.map_err(|e| in_full(&e)))?;
    streams::print(comm, &described.text)?;
    ensure!(
        described.damage.is_empty(),
        "{} is damaged: {}; restore it from a copy, or go on without that: stats leaves damaged frames out",
        args.file.display(),
        described.damage.join("; ")
    );
    Ok(())
}

/// Description of a file or a folder, and the damage found.
#[derive(Default)]
struct Described {
    text: String,
    damage: Vec<String>,
}

fn describe(args: &InfoArgs) -> anyhow::Result<Described> {
    let path = &args.file;
    if path.is_dir() && args.scene {
        let scene = path.join("scene.toml");
        let text = std::fs::read_to_string(&scene).with_context(|| format!("can't read {}", scene.display()))?;
        return Ok(Described { text, damage: Vec::new() });
    }
    if FamilyFolder::holds_family(path) {
        let (text, values) = family::info(path)?;
        return Ok(Described { text: if args.json { json(&values) } else { text }, damage: Vec::new() });
    }
    if path.is_dir() {
        let contents = FolderContents::read(path)?;
        let text = if args.json { json(&serde_json::json!(contents)) } else { contents.to_string() };
        return Ok(Described { text, damage: contents.damage() });
    }
    let contents = read(path)?;
    let text = match (args.scene, args.json) {
        (true, _) => contents.scene(),
        (_, true) => json(&serde_json::json!(contents)),
        _ => contents.to_string(),
    };
    Ok(Described { text, damage: contents.damage })
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
