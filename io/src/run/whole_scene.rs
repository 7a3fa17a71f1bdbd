//! Scenes without time steps, which are computed as a whole.

use super::{Listener, RunError, RunFolder, check_ranks, continuum, sweep};
use crate::{ContinuumScene, Kind, Scene};
use domain::Comm;
use drivers::disks::Sweep;
use std::path::Path;

/// A scene that is computed as a whole, in one process. Results that were complete before an interruption are kept.
pub enum WholeScene<'a> {
    /// Problems to solve.
    Continuum(&'a ContinuumScene),
    /// Runs to make.
    Sweep(&'a Sweep),
}

impl<'a> WholeScene<'a> {
    /// The scene, if it is of a kind without steps.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        match scene.kind() {
            Kind::Continuum(scene) => Some(Self::Continuum(scene)),
            Kind::GranularDisks(scene) => scene.sweep.as_ref().map(Self::Sweep),
            _ => None,
        }
    }

    /// Computes the remaining results.
    pub fn carry_out(
        &self,
        scene: &Scene,
        folder: &RunFolder,
        comm: &Comm,
        listener: &dyn Listener,
    ) -> Result<(), RunError> {
        check_ranks(scene.kind(), comm.size())?;
        folder.manifest().remove_temporary_files();
        match self {
            Self::Continuum(problems) => continuum::solve(problems, scene, folder.manifest(), listener),
            Self::Sweep(runs) => sweep::sweep(runs, scene, folder.manifest(), listener),
        }
    }

    /// Whether a folder contains all results.
    pub fn is_finished(&self, folder: &Path) -> bool {
        match self {
            Self::Continuum(problems) => continuum::is_solved(problems, folder),
            // Written last.
            Self::Sweep(_) => folder.join("sweep.h5").exists(),
        }
    }
}
