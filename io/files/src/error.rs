//! Errors with the files of a run.

use std::path::{Path, PathBuf};

/// A file that could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// Writing failed.
    #[error("can't write {}: {reason}; what was written before is intact", path.display())]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Message of the operating system.
        reason: String,
    },
    /// A file was renamed, removed or cut while the run was writing to it.
    #[error(
        "{} {what} while the run was writing to it; what is gone of it is missing, and the run goes on from its last \
         checkpoint by resume",
        path.display()
    )]
    Lost {
        /// Path of the file.
        path: PathBuf,
        /// The change that was noticed.
        what: String,
    },
    /// Reading failed.
    #[error("can't read {}: {reason}", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
    /// A user's file that a run cannot start from.
    #[error("can't start from {}: {reason}", path.display())]
    Start {
        /// Path of the file.
        path: PathBuf,
        /// The problem, the requirement, and advice.
        reason: String,
    },
    /// The content differs from what was written.
    #[error("{} is damaged: {reason}; restore it from a copy, or move it away", path.display())]
    Damaged {
        /// Path of the file.
        path: PathBuf,
        /// The damage.
        reason: String,
    },
}

impl FileError {
    /// A file that could not be written.
    pub fn write(path: &Path, error: &impl ToString) -> Self {
        Self::Write { path: path.to_owned(), reason: in_plain_words(&error.to_string()) }
    }

    /// A file that could not be read.
    pub fn read(path: &Path, error: &impl ToString) -> Self {
        Self::Read { path: path.to_owned(), reason: in_plain_words(&error.to_string()) }
    }

    /// A file that a run cannot start from.
    pub fn start(path: &Path, error: &impl ToString) -> Self {
        Self::Start { path: path.to_owned(), reason: in_plain_words(&error.to_string()) }
    }

    /// A damaged file.
    pub fn damaged(path: &Path, error: &impl ToString) -> Self {
        Self::Damaged { path: path.to_owned(), reason: in_plain_words(&error.to_string()) }
    }
}

/// Extracts the operating system's message from the middle of a message of the HDF5 library.
fn in_plain_words(reason: &str) -> String {
    match reason.split_once("error message = '").and_then(|(_, rest)| rest.split_once('\'')) {
        Some((words, _)) => words.to_lowercase(),
        None => reason.to_owned(),
    }
}
