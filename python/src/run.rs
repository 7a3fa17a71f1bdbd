//! A simulation, and the folder of its results.

use crate::signals::PythonSignals;
use crate::snapshot::{PySnapshot, count, shared};
use crate::user_loads::{OwnFunction, PendingException};
use domain::Comm;
use files::SCENES;
use pyo3::prelude::*;
use run::{ExistingRun, Recorder, Resumption, RunError, RunFolder};
use scene::Scene;
use simulation::{Rearrangement, Simulation};
use std::path::Path;

/// A simulation, with the recorder of its output.
pub struct Run {
    pub simulation: Box<dyn Simulation>,
    pub raised: PendingException,
    /// The user's load functions, in the order in which they were added.
    own_loads: Vec<OwnFunction>,
    scene: Scene,
    output: Destination,
    signals: PythonSignals,
    /// Last step for which the files have room.
    room: u64,
    /// Whether a step has failed, so that the present state must not be written as a checkpoint.
    has_failed: bool,
}

/// Destination of the results.
#[expect(clippy::large_enum_variant, reason = "there is one")]
enum Destination {
    Nowhere,
    /// A folder in which nothing is written before the first step.
    Folder(RunFolder),
    Files(Recorder),
}

const NO_COLUMN: &str = "the time series in this folder has begun without a column for the stress of your own forces; \
    add forces that have one before the first step, or let them have none";

/// Outcome of an advance.
pub enum AdvanceOutcome {
    AtItsStep,
    Interrupted,
}

impl Run {
    /// Starts a scene. Collective.
    pub fn start(scene: Scene, folder: Option<(&Path, ExistingRun)>, comm: &Comm) -> Result<Self, RunError> {
        let claim = |(path, former)| RunFolder::claim(path, comm, former);
        let folder = comm.agree(folder.map(claim).transpose().map_err(|cause| scene::in_full(&cause)))?;
        let (scene, _) = run::with_start_file(scene, comm)?;
        let (scene, _) = run::with_least_repulsion(run::on_this_machine(scene, comm)?, comm)?;
        let simulation = run::start(&scene, comm, &mut |_| ())?;
        Ok(Self::of(simulation, scene, folder.map_or(Destination::Nowhere, Destination::Folder)))
    }

    /// Resumes the run of a folder from its last checkpoint; returns notes on damaged checkpoints and changed keys,
    /// too. Collective.
    pub fn resume(path: &Path, accepted: &[String], comm: &Comm) -> Result<(Self, Vec<String>), RunError> {
        let folder = comm.agree(RunFolder::reopen(path, comm).map_err(|cause| scene::in_full(&cause)))?;
        let read = if comm.is_first() { SCENES.read(&folder.scene(), &[]).map(Some) } else { Ok(None) };
        let read = comm.agree(read)?;
        let name = folder.scene().display().to_string();
        let text = comm.broadcast_text(read.as_ref().map_or("", Scene::text));
        let scene = read.map_or_else(|| SCENES.parse(&text, &name, &[]), Ok)?;
        let mut resumption = Resumption::of(folder, scene, accepted, comm)?;
        let notes = resumption.damaged().iter().chain(resumption.notes()).cloned().collect();
        let mut simulation = resumption.simulation(comm)?;
        let (recorder, scene) = resumption.record(&mut *simulation)?;
        Ok((Self::of(simulation, scene, Destination::Files(recorder)), notes))
    }

    fn of(mut simulation: Box<dyn Simulation>, scene: Scene, output: Destination) -> Self {
        let (signals, room) = (PythonSignals::default(), scene.kind().steps());
        simulation.listen(signals.interrupt());
        let (raised, own_loads) = (PendingException::default(), Vec::new());
        Self { simulation, raised, own_loads, scene, output, signals, room, has_failed: false }
    }

    /// Adds a load function. Refuses one with a stress if the file of the time series has been started without a column
    /// for it. Collective.
    pub fn add_loads(&mut self, loads: OwnFunction) -> Result<(), RunError> {
        let quantities = self.simulation.quantities();
        let has = |name: &str| quantities.iter().any(|quantity| quantity.name == name);
        let lacks = has("relative_viscosity") && !has("stress_applied");
        if loads.gives.have_stress() && lacks && matches!(self.output, Destination::Files(_)) {
            return Err(RunError::Refused(NO_COLUMN.to_owned()));
        }
        self.simulation.add_loads(self.raised.loads(loads.clone()))?;
        self.own_loads.push(loads);
        Ok(())
    }

    /// The present state. Collective.
    pub fn snapshot(&mut self) -> PySnapshot {
        let state = self.simulation.state();
        PySnapshot::of(state, &self.scene, self.simulation.comm())
    }

    /// Goes back to a state, with the changes that the user of the first rank has made to it. Records after its step
    /// are dropped. If the state is refused, nothing changes. Collective.
    pub fn restore(&mut self, snapshot: &PySnapshot, change: Rearrangement) -> Result<(), RunError> {
        let comm = self.simulation.comm().clone();
        let now = self.simulation.state();
        let state = comm.agree(snapshot.state_for(&self.scene, count(&now, &comm)))?;
        let change = shared(change, &comm);
        let state = if change.is_empty() { state } else { self.simulation.rearranged(state, &change)? };
        let mut simulation = run::resume(&self.scene, Some(state), &comm)?;
        simulation.listen(self.signals.interrupt());
        self.own_loads.iter().try_for_each(|loads| simulation.add_loads(self.raised.loads(loads.clone())))?;
        self.output = match std::mem::replace(&mut self.output, Destination::Nowhere) {
            Destination::Files(recorder) => {
                Destination::Files(recorder.go_back(&self.scene, self.room, &mut *simulation)?)
            }
            output => output,
        };
        (self.simulation, self.has_failed) = (simulation, false);
        Ok(())
    }

    /// The scene's last step.
    pub fn end(&self) -> u64 {
        self.scene.kind().steps()
    }

    /// Warnings about the start and the files.
    pub fn cautions(&self) -> Vec<String> {
        let files = if let Destination::Files(recorder) = &self.output { recorder.warnings() } else { &[] };
        self.simulation.start_warnings().iter().chain(files).cloned().collect()
    }

    /// Advances to step `target`, and records what is due. Collective.
    pub fn run_to(&mut self, target: u64) -> Result<AdvanceOutcome, RunError> {
        self.prepare_files(target)?;
        self.record()?;
        while self.simulation.clock().step() < target && self.simulation.end_reason().is_none() {
            if self.simulation.comm().any(self.signals.interrupt().is_requested()) {
                self.checkpoint()?;
                return Ok(AdvanceOutcome::Interrupted);
            }
            let step = self.simulation.clock().step();
            let due = if let Destination::Files(recorder) = &self.output { recorder.next_due(step) } else { None };
            let advanced = self.simulation.advance(due.map_or(target, |due| due.min(target)));
            self.has_failed = advanced.is_err() && !self.raised.is_any();
            advanced?;
            self.record()?;
        }
        if self.simulation.end_reason().is_some() {
            self.finish()?;
        } else if target == self.end() {
            self.checkpoint()?;
        }
        Ok(AdvanceOutcome::AtItsStep)
    }

    /// Creates the files at the first step, with room until step `target`, or extends files that have too little room.
    fn prepare_files(&mut self, target: u64) -> Result<(), RunError> {
        if let Destination::Nowhere = self.output {
            return Ok(());
        }
        let is_longer = target > self.end();
        if is_longer {
            let end = [format!("time.steps={target}")];
            self.scene = SCENES.parse(self.scene.text(), "the scene with another end", &end)?;
        }
        self.output = match std::mem::replace(&mut self.output, Destination::Nowhere) {
            Destination::Folder(folder) => {
                self.room = self.end();
                Destination::Files(Recorder::create(folder, &self.scene, &mut *self.simulation)?)
            }
            Destination::Files(recorder) if is_longer => {
                if target > self.room {
                    self.room = target.max(2 * self.room);
                }
                Destination::Files(recorder.extend(&self.scene, self.room, &mut *self.simulation)?)
            }
            output => output,
        };
        Ok(())
    }

    fn record(&mut self) -> Result<(), RunError> {
        match &mut self.output {
            Destination::Files(recorder) => recorder.record(&mut *self.simulation),
            _ => Ok(()),
        }
    }

    /// Writes a checkpoint of the present state, if there are files. Collective.
    pub fn checkpoint(&mut self) -> Result<(), RunError> {
        match &mut self.output {
            Destination::Files(recorder) if !self.has_failed => recorder.checkpoint(&mut *self.simulation),
            _ => Ok(()),
        }
    }

    /// Writes the answers and the checkpoint of a run that ended before its last step. Collective.
    fn finish(&mut self) -> Result<(), RunError> {
        match &mut self.output {
            Destination::Files(recorder) => recorder.finish(&mut *self.simulation).map(drop),
            _ => Ok(()),
        }
    }

    /// Writes a last checkpoint and releases the folder. Collective.
    pub fn close(&mut self) -> Result<(), RunError> {
        let saved = self.checkpoint();
        self.output = Destination::Nowhere;
        saved
    }

    /// Takes the exception of a signal handler, to be raised again; on ranks without one, a `KeyboardInterrupt`.
    pub fn interruption(&self) -> PyErr {
        self.signals.take().unwrap_or_else(|| pyo3::exceptions::PyKeyboardInterrupt::new_err("on another rank"))
    }
}
