//! The command line.

use crate::{
    bench, calibrate, check, converge, export, info, manual, mobility, new, report, resume, run, stats, streams,
    two_sphere,
};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use domain::Comm;
use std::ffi::OsString;
use std::process::ExitCode;

/// Particles in viscous flow by the force-coupling method.
#[derive(Parser)]
#[command(version, after_help = EXAMPLES, max_term_width = 100)]
pub struct Args {
    /// Command to carry out.
    #[command(subcommand)]
    pub command: Command,
    /// Threads of each rank [default: `RAYON_NUM_THREADS`, or the cores that it is bound to, shared out among the ranks
    /// bound to the same]
    #[arg(
        long,
        global = true,
        value_name = "N",
        value_parser = clap::value_parser!(u16).range(1..),
        allow_hyphen_values = true
    )]
    pub threads: Option<u16>,
    /// Run as one rank, whatever launcher started this process: for many runs side by side under srun
    #[arg(long, global = true)]
    pub alone: bool,
    /// Log warnings, answers and errors only: no plan, no progress
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  fcm-solve new settling > my.toml        write a scene to start from
  fcm-solve check my.toml                 see whether it is right, and what it will cost
  fcm-solve run my.toml --out results/my  run it
  mpirun -n 4 fcm-solve run my.toml       run it on four ranks
  fcm-solve resume results/my             go on after Ctrl-C, a crash, or the end of a queue's time
  fcm-solve run my.toml --continue        start, or go on, or do nothing if it is finished: for job scripts
  fcm-solve report results/my             a page to look at: charts, and the spheres in motion
  fcm-solve mobility case.json            how given particles move, once
  fcm-solve info results/my/trajectory.h5 see what a result file holds";

/// Commands of the program.
#[derive(Subcommand)]
pub enum Command {
    /// Run a scene from its start.
    Run(run::RunArgs),
    /// Go on with a run from its last checkpoint.
    Resume(resume::ResumeArgs),
    /// Check a scene and print how it would be computed, without running it.
    Check(check::CheckArgs),
    /// Run a scene with half the step, twice the box, a tenth of the tolerance, four times the stiffness, and say which
    /// matters.
    Converge(converge::ConvergeArgs),
    /// Average over a run's trajectory: fluctuations, correlations, diffusivities, pair distributions.
    Stats(stats::StatsArgs),
    /// Write a run's trajectory in a format of other programs: extended XYZ, GSD or VTP.
    Export(export::ExportArgs),
    /// Write a page about a run: what was run, its charts, and a player of its trajectory.
    Report(report::ReportArgs),
    /// Evaluate velocities and stresslets once, for given positions.
    Mobility(mobility::MobilityArgs),
    /// Time the mobility and measure its error.
    Bench(bench::BenchArgs),
    /// Measure what evaluations cost on this machine, for the plans of scenes that are run here.
    Calibrate,
    /// Print the exact resistance functions of two spheres.
    TwoSphere(two_sphere::TwoSphereArgs),
    /// Print a commented scene to start from.
    New(new::NewArgs),
    /// Describe the contents of an HDF5 file of a run.
    Info(info::InfoArgs),
    /// Print the JSON Schema of scenes, with which editors complete and check keys.
    ///
    /// fcm-solve schema > fcm-solve.schema.json, in the folder of scenes printed by `fcm-solve new`: their first line
    /// names it.
    Schema,
    /// Print the manual page.
    ///
    /// To read it: fcm-solve man | man -l -
    Man(manual::Pages),
    /// Print a script that completes commands in a shell.
    ///
    /// For bash: fcm-solve completions bash > ~/.local/share/bash-completion/completions/fcm-solve
    Completions {
        /// The shell.
        shell: Shell,
    },
}

impl Args {
    /// Parses the command line. Help texts and errors of usage are returned as `Err`, to be printed.
    pub fn read() -> Result<Self, clap::Error> {
        Self::try_parse().map_err(|error| match error.kind() {
            ErrorKind::InvalidUtf8 => not_text(error),
            _ => error,
        })
    }
}

/// The error of an argument that is not UTF-8, with that argument named.
fn not_text(error: clap::Error) -> clap::Error {
    let word = std::env::args_os().find(|word| word.to_str().is_none());
    let message = |word: OsString| format!("the word '{}' is not text in UTF-8", word.to_string_lossy());
    word.map(message).map_or(error, |message| Args::command().error(ErrorKind::InvalidUtf8, message))
}

impl Command {
    /// Carries out the command. Collective: it fails on all ranks or on none.
    pub fn carry_out(&self, comm: &Comm) -> anyhow::Result<ExitCode> {
        match self {
            Self::Run(args) => return run::run(args, comm),
            Self::Resume(args) => return resume::run(args, comm),
            Self::Converge(args) => return converge::run(args, comm),
            Self::Check(args) => check::run(args, comm)?,
            Self::Stats(args) => stats::run(args, comm)?,
            Self::Export(args) => export::run(args, comm)?,
            Self::Report(args) => report::run(args, comm)?,
            Self::Mobility(args) => mobility::run(args, comm)?,
            Self::Bench(args) => bench::run(args, comm)?,
            Self::Calibrate => calibrate::calibrate(comm)?,
            Self::TwoSphere(args) => two_sphere::run(args, comm)?,
            Self::New(args) => new::run(args, comm)?,
            Self::Info(args) => info::run(args, comm)?,
            Self::Schema => streams::print(comm, &streams::json(&scene::scene_schema()))?,
            Self::Man(pages) => manual::pages(pages, Args::command(), comm)?,
            Self::Completions { shell } => manual::completions(*shell, &mut Args::command(), comm)?,
        }
        Ok(ExitCode::SUCCESS)
    }
}
