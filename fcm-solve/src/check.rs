//! `fcm-solve check`: plan, memory and cost of a scene.

use crate::family;
use crate::outlined::{OutlinedScene, outlined};
use crate::scene_file::read_any;
use crate::streams::{self, json};
use anyhow::{bail, ensure};
use domain::Comm;
use run::ScaledTrial;
use scene::SceneFile;
use std::path::PathBuf;
use suspension::{Asked, Ranks};

/// Scene to check, and the ranks to predict its cost for.
#[derive(clap::Args)]
pub struct CheckArgs {
    /// The scene file; - reads it from the standard input
    scene: PathBuf,
    /// Set a key of the scene, as in --set time.step=0.01; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Predict memory and time on this number of ranks, which are not started [default: those that are present]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    ranks: Option<u32>,
    /// Ranks that share a machine [default: all of them]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), requires = "ranks")]
    ranks_per_machine: Option<u32>,
    /// Do not try the first steps to predict the time of the run
    #[arg(long)]
    no_trial: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Checks the scene and prints its plan, memory and cost. Collective.
pub fn run(args: &CheckArgs, comm: &Comm) -> anyhow::Result<()> {
    let scene = match read_any(&args.scene, &args.overrides, comm)? {
        SceneFile::Scene(scene) => *scene,
        SceneFile::Family(family) => {
            ensure!(
                args.ranks.is_none(),
                "--ranks goes with single scenes: each run of a family has one; leave it out"
            );
            return streams::print(comm, &family::check(&family, !args.no_trial, args.json)?);
        }
    };
    // The time on ranks that are not present is extrapolated from that on one rank.
    let is_tried = !args.no_trial && (args.ranks.is_none() || comm.size() == 1);
    let asked = asked(args, comm);
    let OutlinedScene { scene, outline, trial } = outlined(scene, asked, is_tried, comm)?;
    let outline = match trial {
        None => outline,
        Some(trial) if asked.are_present => trial.add_to(outline),
        Some(trial) => match ScaledTrial::of(&trial, &scene, rayon::current_num_threads(), asked.ranks) {
            Some(scaled) => scaled.add_to(outline),
            None => trial.add_output_to(outline),
        },
    };
    streams::print(comm, &if args.json { json(&outline.to_json()) } else { outline.to_string() })?;
    outline.refused().map_or(Ok(()), |reason| bail!("{reason}"))
}

/// Ranks to predict memory and time for; ranks that are not present have the threads that this machine would give them.
fn asked(args: &CheckArgs, comm: &Comm) -> Asked {
    let threads = rayon::current_num_threads();
    let Some(count) = args.ranks.map(|ranks| ranks as usize) else { return Asked::present(comm) };
    let on_a_machine = args.ranks_per_machine.map_or(count, |ranks| ranks as usize).min(count);
    Asked { ranks: Ranks { count, threads: (threads / on_a_machine).max(1) }, on_a_machine, are_present: false }
}
