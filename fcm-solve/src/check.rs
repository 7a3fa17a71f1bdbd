//! `fcm-solve check`: what a scene would cost.

use crate::granular;
use crate::machine::on_this_machine;
use crate::run::read;
use crate::streams;
use crate::suspension::Outline;
use domain::Comm;
use io::Kind;
use std::path::PathBuf;

/// Which scene.
#[derive(clap::Args)]
pub struct Args {
    /// The scene file; - reads it from the standard input
    scene: PathBuf,
    /// Set a key of the scene, as in --set time.step=0.01; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
}

/// Checks the scene and prints how it would be computed. Collective.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<()> {
    let scene = on_this_machine(read(&args.scene, &args.overrides, comm)?, comm)?;
    let outline = match scene.kind() {
        Kind::Suspension(scene) => Outline::of(scene, comm)?.to_string(),
        other => granular::outline(other),
    };
    streams::print(comm, &outline)
}
