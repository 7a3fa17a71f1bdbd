//! The folder of a run, held by one program at a time.

use super::RunError;
use crate::{Checkpoints, replace_file};
use domain::Comm;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// What becomes of a run that a folder holds already.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Former {
    /// It stays, and no other starts there.
    Stays,
    /// Another takes its place.
    IsReplaced,
    /// It goes on.
    GoesOn,
}

/// A folder that belongs to this run until it ends.
pub struct RunFolder {
    path: PathBuf,
    /// On the first rank; the system unlocks it when the program ends, however it ends.
    _lock: Option<File>,
}

impl RunFolder {
    /// Takes a folder for a run, unless it holds one that stays.
    pub fn claim(path: &Path, comm: &Comm, former: Former) -> Result<Self, RunError> {
        if comm.is_first() {
            std::fs::create_dir_all(path).map_err(|source| failed("make the folder", path, source))?;
            if path.join(SCENE).exists() && former == Former::Stays {
                let name = path.display();
                return Err(RunError::Refused(format!(
                    "{name} already holds the results of a run: go on with it by --continue, name another folder with \
                     --out, or replace it with --force"
                )));
            }
        }
        Self::hold(path, comm)
    }

    /// Takes the folder of a run to go on with.
    pub fn reopen(path: &Path, comm: &Comm) -> Result<Self, RunError> {
        if comm.is_first() && !path.join(SCENE).exists() {
            let name = path.display();
            return Err(RunError::Refused(format!(
                "{name} holds no run to go on with: it has no {SCENE}; start one by `fcm-solve run SCENE --out {name}`"
            )));
        }
        Self::hold(path, comm)
    }

    fn hold(path: &Path, comm: &Comm) -> Result<Self, RunError> {
        let lock = if comm.is_first() { Some(lock(path)?) } else { None };
        Ok(Self { path: path.to_owned(), _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether a run has begun here. Collective.
    pub fn holds_run(&self, comm: &Comm) -> bool {
        comm.any(comm.is_first() && self.scene().exists())
    }

    /// The scene that is run here.
    pub fn scene(&self) -> PathBuf {
        self.path.join(SCENE)
    }

    /// Removes what a former run left here and writes the scene of this one.
    pub fn start_with(&self, scene: &str) -> Result<(), RunError> {
        Checkpoints::of(&self.path).remove_all()?;
        for name in FILES {
            remove(|| std::fs::remove_file(self.path.join(name)), &self.path.join(name))?;
        }
        for name in ["fields", "statistics", "stats", "trajectory", "cases"] {
            remove(|| std::fs::remove_dir_all(self.path.join(name)), &self.path.join(name))?;
        }
        self.keep(scene)
    }

    /// Writes the scene of this run.
    pub fn keep(&self, scene: &str) -> Result<(), RunError> {
        Ok(replace_file(&self.scene(), scene.as_bytes())?)
    }
}

const SCENE: &str = "scene.toml";

/// Files that a run of any kind may leave here, besides its checkpoints.
const FILES: [&str; 18] = [
    "report.html",
    "trajectory.h5",
    "trajectory.xyz",
    "trajectory.gsd",
    "trajectory.pvd",
    "observables.h5",
    "observables.csv",
    "fields.xdmf",
    "averages.h5",
    "averages.csv",
    "profile.csv",
    "walls.csv",
    "map.csv",
    "totals.csv",
    "solution.h5",
    "summary.csv",
    "sweep.h5",
    "branches.csv",
];

fn lock(path: &Path) -> Result<File, RunError> {
    let name = path.join(".lock");
    let file = File::create(&name).map_err(|source| failed("write", &name, source))?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(RunError::Refused(format!(
            "another run is writing to {}: wait for it, stop it, or name another folder with --out",
            path.display()
        ))),
        // Some file systems have no locks.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(file),
    }
}

fn remove(action: impl FnOnce() -> std::io::Result<()>, path: &Path) -> Result<(), RunError> {
    match action() {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(failed("remove", path, error)),
        _ => Ok(()),
    }
}

fn failed(what: &'static str, path: &Path, source: std::io::Error) -> RunError {
    RunError::Folder { what, path: path.to_owned(), source }
}
