//! What can go wrong with the files of a run.

use std::path::{Path, PathBuf};

/// A file that could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// Writing failed.
    #[error("can't write {}: {reason}; what was written before is intact", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's words.
        reason: String,
    },
    /// A file has lost its name or its content while it was written.
    #[error(
        "{} {what} while the run was writing to it; what is gone of it is missing, and the run goes on from its last checkpoint \
         by resume",
        path.display()
    )]
    Lost {
        /// The file.
        path: PathBuf,
        /// Its fate.
        what: String,
    },
    /// Reading failed.
    #[error("can't read {}: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A file of a user's that a run can't start from.
    #[error("can't start from {}: {reason}", path.display())]
    Start {
        /// The file.
        path: PathBuf,
        /// What was found, what is needed and what to do.
        reason: String,
    },
    /// The content is not what was written.
    #[error("{} is damaged: {reason}; restore it from a copy, or move it away", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

impl FileError {
    pub(crate) fn write(path: &Path, error: &impl ToString) -> Self {
        Self::Write { path: path.to_owned(), reason: in_plain_words(&error.to_string()) }
    }

    pub(crate) fn read(path: &Path, error: &impl ToString) -> Self {
        Self::Read { path: path.to_owned(), reason: in_plain_words(&error.to_string()) }
    }

    pub(crate) fn start(path: &Path, error: &impl ToString) -> Self {
        Self::Start { path: path.to_owned(), reason: in_plain_words(&error.to_string()) }
    }

    pub(crate) fn damaged(path: &Path, error: &impl ToString) -> Self {
        Self::Damaged { path: path.to_owned(), reason: in_plain_words(&error.to_string()) }
    }
}

/// The HDF5 library reports the system's reason in the middle of its own.
fn in_plain_words(reason: &str) -> String {
    match reason.split_once("error message = '").and_then(|(_, rest)| rest.split_once('\'')) {
        Some((words, _)) => words.to_lowercase(),
        None => reason.to_owned(),
    }
}
