//! Checkpoints: everything that a run needs to continue as if it had not stopped.

mod bytes;

use crate::FileError;
use crate::atomic_file;
use simulation::State;
use std::path::{Path, PathBuf};

/// How many checkpoints a folder keeps.
pub(crate) const KEPT: usize = 2;

/// The checkpoints of a run's folder.
#[derive(Debug, Clone, Copy)]
pub struct Checkpoints<'a>(&'a Path);

/// Bytes of a checkpoint of a state.
pub(crate) fn bytes_of(state: &State) -> usize {
    bytes::of(state).len()
}

impl<'a> Checkpoints<'a> {
    /// Those of a folder.
    pub fn of(folder: &'a Path) -> Self {
        Self(folder)
    }

    /// Writes a checkpoint, and removes all but the last two. The file appears under its name only when
    /// it is whole and on the disk.
    pub fn write(&self, state: &State) -> Result<PathBuf, FileError> {
        let path = self.0.join(format!("checkpoint-{:010}.bin", state.step));
        atomic_file::replace(&path, &bytes::of(state))?;
        for old in self.paths()?.iter().rev().skip(KEPT) {
            // What can't be removed now will be after the next one; that is no reason to end a run.
            let _ = std::fs::remove_file(old);
        }
        Ok(path)
    }

    /// Whether there is any, whole or not.
    pub fn any(&self) -> Result<bool, FileError> {
        Ok(!self.paths()?.is_empty())
    }

    /// The state of the last checkpoint that is whole, and what is wrong with those that came after it.
    pub fn latest(&self) -> Result<(State, Vec<FileError>), FileError> {
        let mut damaged = Vec::new();
        for path in self.paths()?.iter().rev() {
            match read(path) {
                Ok(state) => return Ok((state, damaged)),
                Err(error) => damaged.push(error),
            }
        }
        Err(damaged.into_iter().next().unwrap_or_else(|| {
            FileError::read(
                self.0,
                &"there is no checkpoint in this folder: its run was stopped before the first; start it by `fcm-solve run SCENE \
                   --continue`",
            )
        }))
    }

    /// Removes the checkpoints of a former run.
    pub fn remove_all(&self) -> Result<(), FileError> {
        self.paths()?.iter().try_for_each(|old| std::fs::remove_file(old).map_err(|e| FileError::write(old, &e)))
    }

    /// Their files, oldest first.
    fn paths(&self) -> Result<Vec<PathBuf>, FileError> {
        let entries = std::fs::read_dir(self.0).map_err(|e| FileError::read(self.0, &e))?;
        let is_one = |path: &PathBuf| {
            let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
            name.starts_with("checkpoint-") && path.extension().is_some_and(|e| e == "bin")
        };
        let mut paths: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).filter(is_one).collect();
        paths.sort();
        Ok(paths)
    }
}

fn read(path: &Path) -> Result<State, FileError> {
    let bytes = std::fs::read(path).map_err(|e| FileError::read(path, &e))?;
    bytes::state(&bytes).map_err(|reason| FileError::damaged(path, &reason))
}

#[cfg(test)]
mod tests;
