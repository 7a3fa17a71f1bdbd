//! `fcm-solve report`: writes an HTML page about a run.

use crate::causes::in_full;
use crate::streams;
use domain::Comm;
use std::path::PathBuf;

/// Run to report on, and the file of the page.
#[derive(clap::Args)]
pub struct ReportArgs {
    /// The folder of a run, or of a family
    folder: PathBuf,
    /// The page [default: report.html in the folder of the run]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes the page, on the first rank. Collective.
pub fn run(args: &ReportArgs, comm: &Comm) -> anyhow::Result<()> {
    let done = if comm.is_first() { write(args) } else { Ok(()) };
    Ok(comm.agree(done.map_err(|e| in_full(&e)))?)
}

fn write(args: &ReportArgs) -> anyhow::Result<()> {
    let out = args.out.clone().unwrap_or_else(|| args.folder.join("report.html"));
    report::write_report(&args.folder, &out)?;
    streams::print_here(&format!("report     {}\n", out.display()))
}
