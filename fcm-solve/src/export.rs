//! `fcm-solve export`: a run's trajectory for other programs.

use crate::causes::in_full;
use crate::number::finite;
use crate::streams;
use anyhow::ensure;
use clap::ValueEnum;
use domain::Comm;
use io::{Format, FrameRange, Snapshot, TrajectoryReader};
use std::path::PathBuf;

/// Which run, and what of it.
#[derive(clap::Args)]
pub struct Args {
    /// The folder of a run
    folder: PathBuf,
    /// The format
    #[arg(long, value_name = "FORMAT")]
    to: Target,
    /// Leave out what was before this time
    #[arg(long, value_name = "T", value_parser = finite, allow_hyphen_values = true)]
    from: Option<f64>,
    /// Leave out what was after this time
    #[arg(long, value_name = "T", value_parser = finite, allow_hyphen_values = true)]
    until: Option<f64>,
    /// Frames by their numbers, as slices of Python name them: 0 is the first, -1 the last
    #[arg(long, value_name = "START:STOP:STEP", allow_hyphen_values = true)]
    frames: Option<FrameRange>,
    /// The file [default: trajectory.xyz, trajectory.gsd or trajectory.pvd in the folder of the run]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Target {
    /// Extended XYZ, for OVITO and others: text, exact
    Xyz,
    /// GSD of HOOMD-blue, for OVITO and others: binary, single precision
    Gsd,
    /// Points of VTK, for pyvista and others: a .pvd file, and beside it a folder with a file for each frame
    Vtp,
}

impl Target {
    fn format(self) -> Format {
        match self {
            Self::Xyz => Format::Xyz,
            Self::Gsd => Format::Gsd,
            Self::Vtp => Format::Vtp,
        }
    }
}

/// Reads the trajectory frame by frame and writes it, on the first rank. Collective.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<()> {
    let done = if comm.is_first() { write(args) } else { Ok(()) };
    Ok(comm.agree(done.map_err(|e| in_full(&e)))?)
}

fn write(args: &Args) -> anyhow::Result<()> {
    let recorded = TrajectoryReader::open(&args.folder.join("trajectory.h5"))?;
    let format = args.to.format();
    let out = args.out.clone().unwrap_or_else(|| args.folder.join("trajectory").with_extension(format.extension()));
    let mut count = 0;
    let mut frames = meant(args, &recorded)
        .into_iter()
        .filter_map(|frame| whole(&recorded, frame))
        .inspect(|_| count += 1)
        .peekable();
    ensure!(
        frames.peek().is_some(),
        "the trajectory has no whole frame in that span; change --from, --until or --frames"
    );
    io::export(&recorded, &mut frames, format, &out)?;
    streams::print_here(&format!("{count} frames in {}\n", out.display()))
}

/// The numbers of the frames that are asked for.
fn meant(args: &Args, recorded: &TrajectoryReader) -> Vec<usize> {
    let times = recorded.times();
    let span = args.from.unwrap_or(f64::NEG_INFINITY)..=args.until.unwrap_or(f64::INFINITY);
    let numbers: Vec<usize> =
        args.frames.map_or_else(|| (0..times.len()).collect(), |range| range.of(times.len()).collect());
    numbers.into_iter().filter(|&frame| span.contains(&times[frame])).collect()
}

/// A frame, unless it is damaged.
fn whole(recorded: &TrajectoryReader, frame: usize) -> Option<Snapshot> {
    let snapshot = recorded.snapshot(frame);
    snapshot.map_err(|error| streams::log(format_args!("warning: {error}; it is left out of what is exported"))).ok()
}
