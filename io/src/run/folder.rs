//! The folder of a run, locked by one program at a time.

use super::RunError;
use crate::{Checkpoints, replace_file};
use domain::Comm;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// What to do with a run that the folder contains already.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExistingRun {
    /// Keep it, and refuse the folder.
    Keep,
    /// Replace it by a new run.
    Replace,
    /// Continue it.
    Continue,
}

/// The folder of a run, locked until the run ends.
pub struct RunFolder {
    path: PathBuf,
    /// On the first rank; the system unlocks it when the program ends, however it ends.
    _lock: Option<File>,
}

impl RunFolder {
    /// Locks a folder for a run, unless it contains a run that is to be kept.
    pub fn claim(path: &Path, comm: &Comm, former: ExistingRun) -> Result<Self, RunError> {
        if comm.is_first() {
            std::fs::create_dir_all(path).map_err(|source| failed("make the folder", path, source))?;
            if path.join(SCENE).exists() && former == ExistingRun::Keep {
                let name = path.display();
                return Err(RunError::Refused(format!(
                    "{name} already holds the results of a run: go on with it by --continue, name another folder with \
                     --out, or replace it with --force"
                )));
            }
        }
        Self::hold(path, comm)
    }

    /// Locks the folder of a run that is continued.
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

    /// Whether the folder contains a run. Collective.
    pub fn holds_run(&self, comm: &Comm) -> bool {
        comm.any(comm.is_first() && self.scene().exists())
    }

    /// The path of the scene.
    pub fn scene(&self) -> PathBuf {
        self.path.join(SCENE)
    }

    /// Removes the files of a former run and writes the scene of this one.
    pub fn start_with(&self, scene: &str) -> Result<(), RunError> {
        Checkpoints::of(&self.path).remove_all()?;
        for name in FILES {
            remove(|| std::fs::remove_file(self.path.join(name)), &self.path.join(name))?;
        }
        for name in ["fields", "contacts", "force-chains", "statistics", "stats", "trajectory", "cases"] {
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
const FILES: [&str; 20] = [
    "report.html",
    "trajectory.h5",
    "trajectory.xyz",
    "trajectory.gsd",
    "trajectory.pvd",
    "observables.h5",
    "observables.csv",
    "fields.xdmf",
    "contacts.csv",
    "force-chains.pvd",
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_run_leaves_nothing_of_a_former_one() {
        let folder = tempfile::tempdir().unwrap();
        let of = |name: &str| folder.path().join(name);
        std::fs::create_dir(of("stats")).unwrap();
        for name in ["trajectory.h5", "stats/summary.csv", "notes.txt"] {
            std::fs::write(of(name), "former").unwrap();
        }
        let run = RunFolder::claim(folder.path(), &Comm::alone(), ExistingRun::Replace).unwrap();
        run.start_with("new").unwrap();
        assert!(!of("trajectory.h5").exists() && !of("stats").exists());
        assert!(of("notes.txt").exists(), "what is no part of a run stays");
        assert_eq!(std::fs::read(run.scene()).unwrap(), b"new");
        std::fs::create_dir(of("trajectory.h5")).unwrap();
        let error = run.start_with("newer").unwrap_err().to_string();
        assert!(error.contains("trajectory.h5"), "{error}");
    }
}
