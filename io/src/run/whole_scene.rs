//! Scenes that are not advanced in steps: they are carried out as a whole.

use super::{RunError, RunFolder, continuum, sweep};
use crate::{ContinuumScene, Kind, Scene};
use domain::Comm;
use drivers::StartError;
use drivers::disks::Sweep;
use std::path::Path;

/// Who waits for a scene to be carried out.
pub trait Listener: Sync {
    /// Hears of something that was done, or that the user should know.
    fn line(&self, text: &str);

    /// Hears now and then which part of all is done.
    fn part(&self, _part: f64) {}

    /// Whether to go on. It is asked often; from the first no on all is left as it is.
    fn goes_on(&self) -> bool {
        true
    }
}

/// A scene that is carried out as a whole, in one process. What was done before it was interrupted is kept.
pub enum WholeScene<'a> {
    /// Problems to solve.
    Continuum(&'a ContinuumScene),
    /// Runs to make.
    Sweep(&'a Sweep),
}

impl<'a> WholeScene<'a> {
    /// The scene as one of these, if it is one.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        match scene.kind() {
            Kind::Continuum(scene) => Some(Self::Continuum(scene)),
            Kind::GranularDisks(scene) => scene.sweep.as_ref().map(Self::Sweep),
            _ => None,
        }
    }

    /// Does what is left to do.
    pub fn carry_out(
        &self,
        scene: &Scene,
        folder: &RunFolder,
        comm: &Comm,
        listener: &dyn Listener,
    ) -> Result<(), RunError> {
        if comm.size() > 1 {
            return Err(StartError::Processes.into());
        }
        match self {
            Self::Continuum(problems) => continuum::solve(problems, scene, folder.path(), listener),
            Self::Sweep(runs) => sweep::sweep(runs, scene, folder.path(), listener),
        }
    }

    /// Whether a folder has all that there is to do.
    pub fn is_finished(&self, folder: &Path) -> bool {
        match self {
            Self::Continuum(problems) => continuum::is_solved(problems, folder),
            // Written last.
            Self::Sweep(_) => folder.join("sweep.h5").exists(),
        }
    }
}
