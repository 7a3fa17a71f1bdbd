//! Checkpoints: everything that a run needs to continue as if it had not stopped.

mod bytes;
mod scene_record;

use crate::atomic_file;
use crate::{FileError, Manifest, manifest};
use bytes::VerifiedCheckpoint;
use domain::{Comm, Failure};
pub use scene_record::OutputKind;
pub use scene_record::SceneRecord;
use simulation::State;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Number of checkpoints that a folder keeps.
pub const KEPT: usize = 2;

/// The checkpoints in the folder of a run.
#[derive(Debug, Clone, Copy)]
pub struct Checkpoints<'a>(&'a Path);

/// The last intact checkpoint.
#[derive(Debug)]
pub struct Latest {
    /// Its state, with this rank's share of the particles.
    pub state: State,
    /// Its scene; `None` if an older version has written it.
    pub scene: Option<SceneRecord>,
    /// Errors of the damaged checkpoints after it, on the first rank.
    pub damaged: Vec<FileError>,
}

/// Bytes of a checkpoint of a state that is entirely on this rank.
pub fn bytes_of(state: &State, scene: &SceneRecord) -> usize {
    bytes::count(state, scene)
}

impl<'a> Checkpoints<'a> {
    /// The checkpoints in a folder.
    pub fn of(folder: &'a Path) -> Self {
        Self(folder)
    }

    /// Writes a checkpoint of a state, of which each rank contributes its own particles, and removes all but the last
    /// two of those that the run's manifest lists. The file appears under its name only when it is complete and on
    /// the disk. The first rank writes. Collective.
    pub fn write(run: &Manifest, state: &State, scene: &SceneRecord, comm: &Comm) -> Result<(), FileError> {
        let path = Checkpoints(run.folder()).path(state.step);
        let put = |rows: &domain::ById| {
            run.enter(&path)?;
            atomic_file::write_with(&path, |file, _| bytes::write(file, (state, scene), rows))
        };
        let Some(written) = state.particles.by_id_with(&state.statistics, comm, put) else { return Ok(()) };
        written?;
        let mut all = run.files();
        all.retain(|path| is_one(path) && path.is_file());
        all.sort();
        for old in all.iter().rev().skip(KEPT) {
            // A checkpoint that cannot be removed now will be removed after the next one; that
            // is no reason to end a run.
            let _ = run.remove(old);
        }
        Ok(())
    }

    /// Removes those of steps after this one.
    pub fn drop_after(run: &Manifest, step: u64) -> Result<(), FileError> {
        let last = Checkpoints(run.folder()).path(step);
        Checkpoints(run.folder())
            .paths()?
            .into_iter()
            .filter(|path| *path > last)
            .try_for_each(|path| run.remove(&path))
    }

    /// The file of a step.
    pub fn path(&self, step: u64) -> PathBuf {
        self.0.join(format!("checkpoint-{step:010}.bin"))
    }

    /// Whether there is any checkpoint, intact or damaged.
    pub fn any(&self) -> Result<bool, FileError> {
        Ok(!self.paths()?.is_empty())
    }

    /// Step of the last checkpoint, intact or damaged, according to its name.
    pub fn last_step(&self) -> Result<Option<u64>, FileError> {
        let paths = self.paths()?;
        let name = paths.last().and_then(|path| path.file_stem()?.to_str()?.strip_prefix("checkpoint-"));
        Ok(name.and_then(|step| step.parse().ok()))
    }

    /// The last intact checkpoint, with a share of its particles on each rank, and the errors of the damaged ones
    /// after it. The first rank reads. Collective.
    pub fn latest(&self, comm: &Comm) -> Result<Latest, Failure> {
        let opened = if comm.is_first() { self.latest_whole().map(Some) } else { Ok(None) };
        let (whole, damaged) = comm.agree(opened)?.unzip();
        let (state, scene) =
            comm.agree(bytes::dealt(whole, comm).map_err(|reason| FileError::damaged(self.0, &reason)))?;
        Ok(Latest { state, scene, damaged: damaged.unwrap_or_default() })
    }

    fn latest_whole(&self) -> Result<(VerifiedCheckpoint, Vec<FileError>), FileError> {
        let mut damaged = Vec::new();
        for path in self.paths()?.iter().rev() {
            match open(path) {
                Ok(whole) => return Ok((whole, damaged)),
                Err(error) => damaged.push(error),
            }
        }
        Err(damaged.into_iter().next().unwrap_or_else(|| {
            FileError::read(
                self.0,
                &"there is no checkpoint in this folder: its run was stopped before the first; start it by `fcm-solve \
                    run SCENE --continue`",
            )
        }))
    }

    /// Files of the checkpoints, oldest first.
    fn paths(&self) -> Result<Vec<PathBuf>, FileError> {
        let entries = std::fs::read_dir(self.0).map_err(|e| FileError::read(self.0, &e))?;
        let mut paths: Vec<PathBuf> =
            entries.filter_map(|e| Some(e.ok()?.path())).filter(|path| is_one(path)).collect();
        paths.sort();
        Ok(paths)
    }
}

fn is_one(path: &Path) -> bool {
    manifest::is_numbered(path, "checkpoint-", ".bin")
}

fn open(path: &Path) -> Result<VerifiedCheckpoint, FileError> {
    let file = File::open(path).map_err(|e| FileError::read(path, &e))?;
    VerifiedCheckpoint::open(file).map_err(|reason| FileError::damaged(path, &reason))
}

#[cfg(test)]
mod tests;
