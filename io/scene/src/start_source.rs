//! The file that particles start from.

use std::path::PathBuf;

/// A file or the folder of a run to start from, and the choice of its frame and its group of particles.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StartSource {
    /// The file or the folder.
    pub path: PathBuf,
    /// The frame, from 0, or from the end if negative; `None` for the last one.
    pub frame: Option<i64>,
    /// The group of particles of an H5MD file; `None` for the only one.
    pub group: Option<String>,
}

impl StartSource {
    /// The last frame of a file or of a run's folder.
    pub fn last(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), frame: None, group: None }
    }
}
