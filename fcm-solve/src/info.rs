//! `fcm-solve info`: what a result file holds.

use crate::run::in_full;
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
    #[arg(long)]
    scene: bool,
}

/// Describes the file.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<()> {
    let contents = if comm.is_first() { read(&args.file).map(Some) } else { Ok(None) };
    if let Some(contents) = comm.agree(contents.map_err(|e| in_full(&e)))? {
        if args.scene {
            print!("{}", contents.scene);
        } else {
            print!("{contents}");
        }
        let path = args.file.display();
        ensure!(
            contents.damage.is_empty(),
            "{path} is damaged: {}; restore it from a copy, or go on without that: stats leaves damaged frames out",
            contents.damage.join("; ")
        );
    }
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
