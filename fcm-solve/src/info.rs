//! `fcm-solve info`: what a result file holds.

use anyhow::ensure;
use domain::Comm;
use io::Contents;
use std::path::PathBuf;

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
    let contents = if comm.is_first() { Contents::read(&args.file).map(Some) } else { Ok(None) };
    if let Some(contents) = comm.agree(contents)? {
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
