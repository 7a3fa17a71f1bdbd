//! The folder of a run, locked by one process at a time.

use crate::RunError;
use domain::Comm;
use files::{FileError, MANIFEST, Manifest, Obstacles, SCENE, replace_file};
use std::fs::{File, OpenOptions, TryLockError};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

/// Treatment of a run that the folder already contains.
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
    /// Files that runs have made here; known on the first rank.
    manifest: Manifest,
    /// Held on the first rank; the system releases it when the process ends, however it ends.
    _lock: Option<File>,
}

impl RunFolder {
    /// Locks a folder for a run, unless it contains a run that is to be kept, or files that no run has made
    /// under names that a run uses.
    pub fn claim(path: &Path, comm: &Comm, former: ExistingRun) -> Result<Self, RunError> {
        if !comm.is_first() {
            return Ok(Self::elsewhere(path));
        }
        std::fs::create_dir_all(path).map_err(|source| failed("make the folder", path, source))?;
        Self::claim_by(path, former, || lock(path))
    }

    /// Like [`RunFolder::claim`], but waits until other processes have released the folder.
    pub(super) fn claim_when_free(path: &Path, former: ExistingRun) -> Result<Self, RunError> {
        std::fs::create_dir_all(path).map_err(|source| failed("make the folder", path, source))?;
        let held = lock_when_free(path)?;
        Self::claim_by(path, former, || Ok(held))
    }

    fn claim_by(
        path: &Path,
        former: ExistingRun,
        lock: impl FnOnce() -> Result<File, RunError>,
    ) -> Result<Self, RunError> {
        let hold = |manifest| Ok(Self { path: path.to_owned(), manifest, _lock: Some(lock()?) });
        if former == ExistingRun::Continue
            && path.join(SCENE).exists()
            && let Some(manifest) = known_files(path)?
        {
            return hold(manifest);
        }
        let manifest = Manifest::open(path)?;
        let has_results = manifest.as_ref().is_some_and(|manifest| manifest.files().iter().any(|file| file.exists()));
        if has_results && former != ExistingRun::Replace {
            return Err(RunError::Refused(kept(path)));
        }
        refuse_obstacles(path, manifest.as_ref())?;
        hold(manifest.unwrap_or_else(|| Manifest::none(path)))
    }

    /// Locks the folder of a run to be continued.
    pub fn reopen(path: &Path, comm: &Comm) -> Result<Self, RunError> {
        if !comm.is_first() {
            return Ok(Self::elsewhere(path));
        }
        let name = path.display();
        if !path.join(SCENE).exists() {
            return Err(RunError::Refused(format!(
                "{name} holds no run to go on with: it has no {SCENE}; start one by `fcm-solve run SCENE --out {name}`"
            )));
        }
        match known_files(path)? {
            Some(manifest) => Ok(Self { path: path.to_owned(), manifest, _lock: Some(lock(path)?) }),
            None => Err(RunError::Refused(format!(
                "{name} holds no run to go on with: it has a {SCENE}, but neither {MANIFEST} nor any other file that \
                 a run has written; start one in another folder by `fcm-solve run {name}/{SCENE} --out DIR`"
            ))),
        }
    }

    /// The folder on a rank that writes nothing.
    fn elsewhere(path: &Path) -> Self {
        Self { path: path.to_owned(), manifest: Manifest::none(path), _lock: None }
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Files that runs have made here; known on the first rank only.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Whether the folder contains a run. Collective.
    pub fn holds_run(&self, comm: &Comm) -> bool {
        comm.any(comm.is_first() && self.scene().exists())
    }

    /// Path of the scene.
    pub fn scene(&self) -> PathBuf {
        self.path.join(SCENE)
    }

    /// `Err` if the scene is missing, without which the run cannot be continued.
    pub(super) fn check_scene(&self) -> Result<(), FileError> {
        if self.scene().is_file() {
            return Ok(());
        }
        Err(FileError::Lost { path: self.scene(), what: "was removed or renamed".to_owned() })
    }

    /// Removes the files of a former run, which its manifest lists, and writes the manifest and the scene of this one.
    pub fn start_with(&mut self, scene: &str) -> Result<(), RunError> {
        let former = Manifest::open(&self.path)?;
        let former = former.as_ref().unwrap_or(&self.manifest);
        refuse_obstacles(&self.path, Some(former))?;
        former.remove_temporary_files();
        former.remove_all()?;
        self.manifest = Manifest::begin(&self.path, scene, Some(former))?;
        self.manifest.remove_temporary_files();
        self.keep(scene)
    }

    /// Removes everything that a run has left here.
    pub(super) fn clear(self) -> Result<(), RunError> {
        self.manifest.remove_temporary_files();
        self.manifest.remove_all()?;
        Ok(self.manifest.discard()?)
    }

    /// Stores the scene of this run.
    pub fn keep(&self, scene: &str) -> Result<(), RunError> {
        self.manifest.enter(&self.scene())?;
        replace_file(&self.scene(), scene.as_bytes())?;
        Ok(self.manifest.note_scene(scene)?)
    }
}

/// Manifest of the files of a run, or of a run of an older version; `None` if there are no files of a run.
fn known_files(path: &Path) -> Result<Option<Manifest>, RunError> {
    match Manifest::open(path)? {
        Some(manifest) => Ok(Some(manifest)),
        None => Ok(Manifest::of_older_version(path)?),
    }
}

fn kept(path: &Path) -> String {
    let (name, has_scene) = (path.display(), path.join(SCENE).exists());
    let continued = if has_scene {
        "go on with it by --continue".to_owned()
    } else {
        format!("its {SCENE} is gone: put it back to go on with it by --continue")
    };
    format!(
        "{name} already holds the results of a run: {continued}, name another folder with --out, or replace it with \
         --force"
    )
}

/// Refuses a folder with files of others under names that a run uses.
fn refuse_obstacles(path: &Path, manifest: Option<&Manifest>) -> Result<(), RunError> {
    let obstacles = Obstacles::of(path, manifest)?;
    if obstacles.is_empty() {
        return Ok(());
    }
    let name = path.display();
    let has_manifest = path.join(MANIFEST).exists();
    if !has_manifest && path.join(SCENE).exists() && Manifest::of_older_version(path)?.is_some() {
        return Err(RunError::Refused(format!(
            "{name} already holds the results of a run of an older version, which wrote no {MANIFEST} to tell its \
             files from others ({obstacles}): go on with it by --continue, name another folder with --out, or move or \
             delete the folder by hand; --force removes only what a manifest lists"
        )));
    }
    Err(RunError::Refused(format!(
        "{name} has files that no run is known to have made, under names that a run uses: {obstacles}; name another \
         folder with --out, or move them away; --force removes only what {MANIFEST} lists, which a run writes"
    )))
}

/// Name of the lock file of a folder.
const LOCK: &str = ".lock";

/// Locks the file `.lock`, which is created if it does not exist and otherwise left unchanged.
fn lock(path: &Path) -> Result<File, RunError> {
    let file = lock_file(path)?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(RunError::Refused(format!(
            "another run is writing to {}: wait for it, stop it, or name another folder with --out",
            path.display()
        ))),
        // Some file systems have no locks.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(file),
    }
}

/// Waits for the lock.
pub(super) fn lock_when_free(path: &Path) -> Result<File, RunError> {
    let file = lock_file(path)?;
    // Some file systems have no locks.
    let _ = file.lock();
    Ok(file)
}

/// Whether a process is writing to a folder.
pub(super) fn is_locked(path: &Path) -> bool {
    let file = File::open(path.join(LOCK));
    file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

fn lock_file(path: &Path) -> Result<File, RunError> {
    let name = path.join(LOCK);
    let (mut options, flags) = (OpenOptions::new(), libc::O_NOFOLLOW | libc::O_NONBLOCK);
    options.read(true).write(true).create(true).truncate(false).custom_flags(flags);
    options.open(&name).map_err(|source| failed("lock the folder by", &name, source))
}

fn failed(what: &'static str, path: &Path, source: std::io::Error) -> RunError {
    RunError::Folder { what, path: path.to_owned(), source }
}

#[cfg(test)]
mod tests;
