//! What a scene runs, as the march and the recorder see it.

use crate::clock::Clock;
use crate::granular::{self, CellRun, DiskRun};
use crate::suspension::Observed;
use anyhow::bail;
use domain::{Comm, Interrupt};
use io::{Checkpoint, FileError, Frame, Kind, Provenance, Quantity, Scene};
use std::path::Path;

/// A system that goes from step to step. Every call is collective; what is written is that of the first rank.
pub trait Simulation {
    /// The ranks.
    fn comm(&self) -> &Comm;

    /// The time.
    fn clock(&self) -> &Clock;

    /// How it is computed, in words.
    fn plan(&mut self) -> String;

    /// Tells it where to look for requests to stop. One whose steps may be long looks there within a step, and returns from
    /// [`Self::advance`] where that step began.
    fn listen(&mut self, _interrupt: Interrupt) {}

    /// Takes a step, or as many as take no time worth speaking of, none of them beyond step `last`. `Err` on every rank
    /// or on none.
    fn advance(&mut self, last: u64) -> anyhow::Result<()>;

    /// The particles now.
    fn frame(&self) -> Frame;

    /// What a row of the time series consists of.
    fn quantities(&self) -> Vec<Quantity>;

    /// A row of the time series: the numbers of each quantity in turn.
    fn observe(&mut self) -> Vec<Vec<f64>>;

    /// Takes what is averaged from the step where it is.
    fn sample(&mut self) {}

    /// The state, from which it goes on bit for bit.
    fn checkpoint(&mut self) -> anyhow::Result<Checkpoint>;

    /// Writes the velocity of the fluid, if there is one.
    fn write_field(&mut self, _folder: &Path, _provenance: &Provenance) -> Result<(), FileError> {
        Ok(())
    }

    /// Writes averages over the run so far, if it has some.
    fn write_averages(&mut self, _folder: &Path, _provenance: &Provenance) -> Result<(), FileError> {
        Ok(())
    }

    /// What the user should know at the end.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}

/// A scene at its start.
pub fn start(scene: &Scene, comm: &Comm) -> anyhow::Result<Box<dyn Simulation>> {
    if !matches!(scene.kind(), Kind::Suspension(_)) {
        granular::check_room(scene.kind(), comm)?;
    }
    Ok(match scene.kind() {
        Kind::Suspension(scene) => Box::new(Observed::start(scene, comm)?),
        Kind::GranularDisks(scene) => Box::new(DiskRun::start(scene, comm)?),
        Kind::ShearCell(scene) => Box::new(CellRun::start(scene, comm)?),
        _ => bail!("scenes of this kind have no steps"),
    })
}

/// A scene as a checkpoint has it, which the first rank brings.
pub fn resume(scene: &Scene, checkpoint: Option<Checkpoint>, comm: &Comm) -> anyhow::Result<Box<dyn Simulation>> {
    if !matches!(scene.kind(), Kind::Suspension(_)) {
        granular::check_room(scene.kind(), comm)?;
    }
    Ok(match (scene.kind(), checkpoint) {
        (Kind::Suspension(scene), checkpoint) => Box::new(Observed::resume(scene, checkpoint, comm)?),
        (Kind::GranularDisks(scene), Some(checkpoint)) => Box::new(DiskRun::resume(scene, &checkpoint, comm)?),
        (Kind::ShearCell(scene), Some(checkpoint)) => Box::new(CellRun::resume(scene, &checkpoint, comm)?),
        _ => bail!("scenes of this kind have no steps"),
    })
}
