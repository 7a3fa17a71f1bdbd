//! `fcm-solve export`: a run's trajectory, or its force chains, in formats of other programs.

use crate::causes::in_full;
use crate::number::finite;
use crate::streams;
use anyhow::ensure;
use clap::ValueEnum;
use domain::Comm;
use files::{ContactFormat, FileError, Format, FrameRange, Manifest, RecordedContacts, TrajectoryReader};
use std::path::PathBuf;

/// Run, frames, format and file of an export.
#[derive(clap::Args)]
pub struct ExportArgs {
    /// The folder of a run
    folder: PathBuf,
    /// The format
    #[arg(long, value_name = "FORMAT")]
    to: Target,
    /// Leave out the part before this time
    #[arg(long, value_name = "T", value_parser = finite, allow_hyphen_values = true)]
    from: Option<f64>,
    /// Leave out the part after this time
    #[arg(long, value_name = "T", value_parser = finite, allow_hyphen_values = true)]
    until: Option<f64>,
    /// Frames by number, as a slice of Python: 0 is the first, -1 the last
    #[arg(long, value_name = "START:STOP:STEP", allow_hyphen_values = true)]
    frames: Option<FrameRange>,
    /// The file [default: trajectory.xyz, trajectory.gsd, trajectory.pvd, contacts.csv or force-chains.pvd in the
    /// folder of the run]
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
    /// Forces of contacts as a table
    ContactsCsv,
    /// Force chains as lines of VTK, like vtp
    ContactsVtp,
}

/// Content of an export: frames of the trajectory, or contacts.
enum Wanted {
    Frames(Format),
    Contacts(ContactFormat),
}

impl Target {
    fn wanted(self) -> Wanted {
        match self {
            Self::Xyz => Wanted::Frames(Format::Xyz),
            Self::Gsd => Wanted::Frames(Format::Gsd),
            Self::Vtp => Wanted::Frames(Format::Vtp),
            Self::ContactsCsv => Wanted::Contacts(ContactFormat::Csv),
            Self::ContactsVtp => Wanted::Contacts(ContactFormat::Vtp),
        }
    }
}

/// Reads and writes frame by frame, on the first rank. Collective.
pub fn run(args: &ExportArgs, comm: &Comm) -> anyhow::Result<()> {
    let done = if comm.is_first() { write(args) } else { Ok(()) };
    Ok(comm.agree(done.map_err(|e| in_full(&e)))?)
}

fn write(args: &ExportArgs) -> anyhow::Result<()> {
    match args.to.wanted() {
        Wanted::Frames(format) => write_frames(args, format),
        Wanted::Contacts(format) => write_contacts(args, format),
    }
}

fn write_frames(args: &ExportArgs, format: Format) -> anyhow::Result<()> {
    let recorded = TrajectoryReader::open(&args.folder.join("trajectory.h5"))?;
    let out = args.out.clone().unwrap_or_else(|| args.folder.join("trajectory").with_extension(format.extension()));
    let mut count = 0;
    let mut frames = meant(args, recorded.times())
        .into_iter()
        .filter_map(|frame| whole(recorded.snapshot(frame)))
        .inspect(|_| count += 1)
        .peekable();
    ensure!(
        frames.peek().is_some(),
        "the trajectory has no whole frame in that span; change --from, --until or --frames"
    );
    files::export(&recorded, &mut frames, format, &out, &Manifest::of(&args.folder)?)?;
    streams::print_here(&format!("{count} frames in {}\n", out.display()))
}

fn write_contacts(args: &ExportArgs, format: ContactFormat) -> anyhow::Result<()> {
    let recorded = RecordedContacts::of(&args.folder)?;
    let folder = args.folder.display();
    ensure!(
        !recorded.clocks().is_empty(),
        "{folder} has no contacts; a run writes them if output.contacts_every is set"
    );
    let name = match format {
        ContactFormat::Csv => "contacts",
        ContactFormat::Vtp => "force-chains",
    };
    let out = args.out.clone().unwrap_or_else(|| args.folder.join(name).with_extension(format.extension()));
    let times: Vec<f64> = recorded.clocks().iter().map(|clock| clock.1).collect();
    let mut count = 0;
    let mut steps = meant(args, &times)
        .into_iter()
        .filter_map(|place| whole(recorded.at(place)))
        .inspect(|_| count += 1)
        .peekable();
    ensure!(steps.peek().is_some(), "there are no whole contacts in that span; change --from, --until or --frames");
    files::export_contacts(&mut steps, format, &out, &Manifest::of(&args.folder)?)?;
    streams::print_here(&format!("{count} steps in {}\n", out.display()))
}

/// Indices of the frames asked for, among frames at `times`.
fn meant(args: &ExportArgs, times: &[f64]) -> Vec<usize> {
    let span = args.from.unwrap_or(f64::NEG_INFINITY)..=args.until.unwrap_or(f64::INFINITY);
    let numbers: Vec<usize> =
        args.frames.map_or_else(|| (0..times.len()).collect(), |range| range.of(times.len()).collect());
    numbers.into_iter().filter(|&frame| span.contains(&times[frame])).collect()
}

/// The result of a read; `None`, with a warning, if it is damaged.
fn whole<T>(read: Result<T, FileError>) -> Option<T> {
    read.map_err(|error| streams::log(format_args!("warning: {error}; it is left out of what is exported"))).ok()
}
