//! A suspension as the march and the recorder see it.

use super::averages::Averages;
use super::cautions::cautions;
use super::observe::Observer;
use super::plan::Radii;
use super::{ANGULAR_VELOCITY, STRESSLET, StepError, Suspension};
use crate::clock::Clock;
use crate::integrator::VELOCITY;
use crate::simulation::Simulation;
use domain::{Comm, Interrupt};
use fcm::PlanError;
use io::{Checkpoint, FileError, Frame, Provenance, Quantity, SuspensionScene, VelocityField};
use std::path::Path;

/// A suspension and who observes it.
pub struct Observed {
    suspension: Suspension,
    observer: Observer,
    averages: Option<Averages>,
}

/// The columns of a frame of the trajectory.
const FRAME: [&str; 3] = [VELOCITY, ANGULAR_VELOCITY, STRESSLET];

impl Observed {
    /// A scene at time zero. Collective.
    pub fn start(scene: &SuspensionScene, comm: &Comm) -> anyhow::Result<Self> {
        Ok(Self::of(scene, Suspension::start(scene, comm)?))
    }

    /// A scene as a checkpoint has it, which the first rank brings. Collective.
    pub fn resume(scene: &SuspensionScene, mut checkpoint: Option<Checkpoint>, comm: &Comm) -> anyhow::Result<Self> {
        let statistics = checkpoint.as_mut().map(|c| std::mem::take(&mut c.statistics)).unwrap_or_default();
        let mut resumed = Self::of(scene, Suspension::resume(scene, checkpoint, comm)?);
        let taken_up = resumed.averages.as_mut().map_or(Ok(()), |averages| averages.take_up(&statistics));
        comm.agree(taken_up)?;
        Ok(resumed)
    }

    fn of(scene: &SuspensionScene, suspension: Suspension) -> Self {
        let frame = suspension.gathered(Some(&FRAME));
        let comm = suspension.comm();
        let radii = Radii::shared(&frame, comm);
        let observer = Observer::new(scene, suspension.clock().step(), radii.smallest());
        for caution in cautions(scene, &radii).iter().filter(|_| comm.is_first()) {
            crate::streams::log(format_args!("warning: {caution}"));
        }
        let averages = scene.statistics.map(|wanted| Averages::new(scene, wanted, &frame));
        Self { suspension, observer, averages }
    }
}

impl Simulation for Observed {
    fn comm(&self) -> &Comm {
        self.suspension.comm()
    }

    fn clock(&self) -> &Clock {
        self.suspension.clock()
    }

    fn plan(&mut self) -> String {
        self.suspension.plan()
    }

    fn listen(&mut self, interrupt: Interrupt) {
        self.suspension.listen(interrupt);
    }

    fn advance(&mut self, _last: u64) -> anyhow::Result<()> {
        match self.suspension.step() {
            Err(StepError::Interrupted(_)) => Ok(()),
            taken => Ok(taken?),
        }
    }

    fn frame(&self) -> Frame {
        let particles = self.suspension.gathered(Some(&FRAME));
        Frame { particles, cell: *self.suspension.cell(), periodic: [true; 3] }
    }

    fn quantities(&self) -> Vec<Quantity> {
        self.observer.quantities()
    }

    fn observe(&mut self) -> Vec<Vec<f64>> {
        self.observer.observe(&mut self.suspension)
    }

    fn sample(&mut self) {
        if let Some(averages) = &mut self.averages {
            averages.sample(&self.suspension);
        }
    }

    fn checkpoint(&mut self) -> anyhow::Result<Checkpoint> {
        let statistics = self.averages.as_mut().map(Averages::state).unwrap_or_default();
        Ok(Checkpoint { statistics, ..self.suspension.checkpoint() })
    }

    fn warnings(&self) -> Vec<String> {
        self.observer.warning().into_iter().collect()
    }

    fn write_averages(&mut self, folder: &Path, provenance: &Provenance) -> Result<(), FileError> {
        let first = self.suspension.comm().is_first();
        self.averages.as_ref().filter(|_| first).map_or(Ok(()), |averages| averages.write(folder, provenance))
    }

    fn write_field(&mut self, folder: &Path, provenance: &Provenance) -> Result<(), FileError> {
        let unplanned = |e: PlanError| FileError::Write { path: folder.join("fields"), reason: e.to_string() };
        let (points, values) = self.suspension.velocity_field().map_err(unplanned)?;
        let field = VelocityField {
            step: self.suspension.clock().step(),
            time: self.suspension.clock().time(),
            cell: *self.suspension.cell(),
            points,
            values: &values,
            note: "relative to the background flow",
        };
        if self.suspension.comm().is_first() { field.write(folder, provenance) } else { Ok(()) }
    }
}
