//! Checkpoints: everything a run needs to go on as if it had not stopped.

mod bytes;

use crate::FileError;
use crate::durable;
use domain::Particles;
use std::path::{Path, PathBuf};

/// How many checkpoints a folder keeps.
const KEPT: usize = 2;

/// The state of a run between two steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// Steps taken so far.
    pub step: u64,
    /// The box's Lees-Edwards strain.
    pub strain: f64,
    /// How the fluid was computed, in words: a run goes on bit for bit if it is computed the same way.
    pub plan: String,
    /// All particles in the order of their ids, with all their columns.
    pub particles: Particles,
    /// What the run has counted and averaged so far, as it stores it; empty where there is nothing of the kind.
    pub statistics: Vec<u8>,
}

impl Checkpoint {
    /// Writes a checkpoint into a folder, and removes all but the last two. The file appears under its name only when
    /// it is whole and on the disk.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, FileError> {
        let path = folder.join(format!("checkpoint-{:010}.bin", self.step));
        durable::replace(&path, &self.to_bytes())?;
        for old in checkpoints(folder)?.iter().rev().skip(KEPT) {
            // What can't be removed now will be after the next one; that is no reason to end a run.
            let _ = std::fs::remove_file(old);
        }
        Ok(path)
    }

    /// Whether a folder has any checkpoint, whole or not.
    pub fn is_in(folder: &Path) -> Result<bool, FileError> {
        Ok(!checkpoints(folder)?.is_empty())
    }

    /// The last checkpoint of a folder that is whole, and what is wrong with those that came after it.
    pub fn latest(folder: &Path) -> Result<(Self, Vec<FileError>), FileError> {
        let mut damaged = Vec::new();
        for path in checkpoints(folder)?.iter().rev() {
            match Self::read(path) {
                Ok(checkpoint) => return Ok((checkpoint, damaged)),
                Err(error) => damaged.push(error),
            }
        }
        Err(damaged.into_iter().next().unwrap_or_else(|| {
            FileError::read(
                folder,
                &"there is no checkpoint in this folder: its run was stopped before the first; start it by `fcm-solve run SCENE \
                   --continue`",
            )
        }))
    }

    fn read(path: &Path) -> Result<Self, FileError> {
        let bytes = std::fs::read(path).map_err(|e| FileError::read(path, &e))?;
        Self::from_bytes(&bytes).map_err(|reason| FileError::damaged(path, &reason))
    }

    /// Drops the checkpoints of a former run.
    pub fn remove_all(folder: &Path) -> Result<(), FileError> {
        checkpoints(folder)?.iter().try_for_each(|old| std::fs::remove_file(old).map_err(|e| FileError::write(old, &e)))
    }
}

/// The checkpoints of a folder, oldest first.
fn checkpoints(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    let entries = std::fs::read_dir(folder).map_err(|e| FileError::read(folder, &e))?;
    let is_one = |path: &PathBuf| {
        let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
        name.starts_with("checkpoint-") && path.extension().is_some_and(|e| e == "bin")
    };
    let mut paths: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).filter(is_one).collect();
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests;
