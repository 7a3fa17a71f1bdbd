//! Scenes without time steps, which are computed as a whole.

use crate::{Listener, RunError, RunFolder, check_ranks, continuum};
use domain::Comm;
use scene::{ContinuumScene, Kind, Scene};
use std::path::Path;

/// A scene that is carried out as a whole, in one process: problems of a continuum to solve.
pub struct WholeScene<'a>(&'a ContinuumScene);

impl<'a> WholeScene<'a> {
    /// The scene, if it is of a kind without steps.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        if let Kind::Continuum(problems) = scene.kind() { Some(Self(problems)) } else { None }
    }

    /// Does the work.
    pub fn carry_out(
        &self,
        scene: &Scene,
        folder: &RunFolder,
        comm: &Comm,
        listener: &dyn Listener,
    ) -> Result<(), RunError> {
        check_ranks(scene.kind(), comm.size())?;
        folder.manifest().remove_temporary_files();
        continuum::solve(self.0, scene, folder.manifest(), listener)
    }

    /// Whether a folder contains all results.
    pub fn is_finished(&self, folder: &Path) -> bool {
        continuum::is_solved(self.0, folder)
    }
}
