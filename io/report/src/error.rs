//! Errors of making a report.

use files::FileError;
use std::path::PathBuf;

/// Reasons why a report cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file that cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A folder without a run.
    #[error("{} holds no run: it has no scene.toml and no results; name the folder of a run", folder.display())]
    NoRun {
        /// The folder.
        folder: PathBuf,
    },
    /// A run without results to show.
    #[error(
        "{} has a scene, but no results to report: no trajectory.h5, observables.h5, averages.h5, \
         solution.h5 or family.h5; finish the run, or set output.trajectory_every or output.observables_every",
        folder.display()
    )]
    NoResults {
        /// The folder.
        folder: PathBuf,
    },
}
