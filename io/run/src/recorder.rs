//! Output files of a run.

use crate::open_files::{Files, OpenParameters};
use crate::{RunError, RunFolder};
use domain::{ById, Comm};
use files::{Checkpoints, ParticleRows, Provenance, SceneRecord, Series, write_contacts, write_field, write_tables};
use report::{AnswerRange, RunAnswer, run_answers, write_answers};
use scene::{OutputSchedules, Scene, in_full};
use simulation::Simulation;
use std::path::Path;
use std::time::{Duration, Instant};

/// Writes the output files of a run at the steps at which they are due. The first rank writes;
/// every call is collective.
pub struct Recorder {
    folder: RunFolder,
    output: OutputSchedules,
    provenance: Provenance,
    /// The scene that checkpoints belong to.
    scene: SceneRecord,
    files: Files,
    comm: Comm,
    /// First step to be recorded: earlier ones are in the files already.
    from: u64,
    /// Step of the last checkpoint.
    saved: Option<u64>,
    /// Last step of the run.
    last: u64,
    /// Longest time that a checkpoint took.
    longest_checkpoint: Duration,
    /// Whether the stored scene has the parameters that the simulation has found.
    has_found: bool,
    /// Answers of a run that has ended, on the first rank.
    answers: Option<Vec<RunAnswer>>,
}

/// A scene, and the record of that of an earlier part of the run, if it is known.
pub(super) struct SceneInForce<'a> {
    pub scene: &'a Scene,
    pub former: Option<SceneRecord>,
}

/// Steps of the files: the last one of an earlier part of the run, and the one up to which there is room.
struct RowSpan {
    last: Option<u64>,
    room: u64,
}

impl Recorder {
    /// A recorder for a new run, which replaces any former run in the folder.
    pub fn create(folder: RunFolder, scene: &Scene, simulation: &mut dyn Simulation) -> Result<Self, RunError> {
        let comm = simulation.comm().clone();
        let mut folder = folder;
        let emptied = if comm.is_first() { folder.start_with(scene.text()) } else { Ok(()) };
        comm.agree(emptied.map_err(|e| in_full(&e)))?;
        Self::open(
            folder,
            SceneInForce { scene, former: None },
            simulation,
            RowSpan { last: None, room: scene.kind().steps() },
        )
    }

    /// A recorder for a run that is resumed with a scene, from a checkpoint with the scene of
    /// that time, if that is known.
    pub(super) fn resume(
        folder: RunFolder,
        scenes: SceneInForce,
        simulation: &mut dyn Simulation,
    ) -> Result<Self, RunError> {
        let text = scenes.scene.text();
        let (last, room) = (simulation.clock().step(), scenes.scene.kind().steps());
        let recorder = Self::open(folder, scenes, simulation, RowSpan { last: Some(last), room })?;
        let is_other = || std::fs::read_to_string(recorder.folder.scene()).ok().as_deref() != Some(text);
        let kept = if recorder.comm.is_first() && is_other() { recorder.folder.keep(text) } else { Ok(()) };
        recorder.comm.agree(kept.map_err(|e| in_full(&e)))?;
        Ok(recorder)
    }

    /// The same run with another end, that of `scene`, in files with room until step `room`. Written data are kept.
    pub fn extend(self, scene: &Scene, room: u64, simulation: &mut dyn Simulation) -> Result<Self, RunError> {
        let Self { folder, files, comm, scene: record, .. } = self;
        drop(files);
        let kept = if comm.is_first() { folder.keep(scene.text()) } else { Ok(()) };
        comm.agree(kept.map_err(|e| in_full(&e)))?;
        let last = simulation.clock().step();
        Self::open(folder, SceneInForce { scene, former: Some(record) }, simulation, RowSpan { last: Some(last), room })
    }

    /// The same run of a scene from the step on to which the simulation has gone back, in files with room until step
    /// `room`. What was written after it is dropped. Collective.
    pub fn go_back(self, scene: &Scene, room: u64, simulation: &mut dyn Simulation) -> Result<Self, RunError> {
        let Self { folder, files, comm, scene: record, .. } = self;
        drop(files);
        let step = simulation.clock().step();
        let dropped = if comm.is_first() { Checkpoints::drop_after(folder.manifest(), step) } else { Ok(()) };
        comm.agree(dropped.map_err(|e| in_full(&e)))?;
        let mut recorder = Self::open(
            folder,
            SceneInForce { scene, former: Some(record) },
            simulation,
            RowSpan { last: Some(step), room },
        )?;
        recorder.renew_checkpoint(simulation)?;
        Ok(recorder)
    }

    fn open(
        folder: RunFolder,
        SceneInForce { scene, former }: SceneInForce,
        simulation: &mut dyn Simulation,
        RowSpan { last, room }: RowSpan,
    ) -> Result<Self, RunError> {
        let comm = simulation.comm().clone();
        let output = scene.kind().output().ok_or(RunError::NoSteps)?.clone();
        let provenance = provenance(scene, simulation.plan(), &comm);
        let (frame, quantities) = (simulation.frame_share(), simulation.quantities());
        let record = match (former, last) {
            (Some(former), Some(last)) => former.changed(scene.text(), &output, last),
            _ => SceneRecord::new(scene.text(), &output),
        };
        let open = OpenParameters { run: folder.manifest(), provenance: &provenance, scene: &record, last, room };
        let files = frame
            .particles
            .by_id(&comm, |rows| open.files(&output, ParticleRows { rows, periodic: frame.periodic }, &quantities));
        let files = comm.agree(files.unwrap_or_else(|| Ok(Files::default())))?;
        let from = last.map_or(0, |step| step + 1);
        let steps = scene.kind().steps();
        Ok(Self {
            folder,
            output,
            provenance,
            scene: record,
            files,
            comm,
            from,
            saved: last,
            last: steps,
            longest_checkpoint: Duration::ZERO,
            has_found: false,
            answers: None,
        })
    }

    /// Folder of the results.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Warnings about the files.
    pub fn warnings(&self) -> &[String] {
        &self.files.warnings
    }

    /// First step after this one at which any output is due.
    pub fn next_due(&self, step: u64) -> Option<u64> {
        let OutputSchedules { trajectory, observables, checkpoints, fields, contacts, .. } = &self.output;
        [trajectory, observables, checkpoints, fields, contacts].into_iter().filter_map(|s| s.next_after(step)).min()
    }

    /// Writes the output that is due at the present step of the simulation.
    pub fn record(&mut self, simulation: &mut dyn Simulation) -> Result<(), RunError> {
        let step = simulation.clock().step();
        if step < self.from {
            return Ok(());
        }
        self.keep_found(simulation)?;
        if self.output.trajectory.is_due(step) {
            self.frame(simulation)?;
        }
        if self.output.observables.is_due(step) {
            self.row(simulation)?;
        }
        if self.output.fields.is_due(step) {
            self.field(simulation)?;
        }
        if self.output.contacts.is_due(step) {
            self.contacts(simulation)?;
        }
        simulation.sample();
        if self.output.checkpoints.is_due(step) || step == 0 {
            self.checkpoint(simulation)?;
        }
        self.from = step + 1;
        Ok(())
    }

    /// Stores parameters that the simulation has found in the scene, in addition to the user's.
    fn keep_found(&mut self, simulation: &dyn Simulation) -> Result<(), RunError> {
        let Some(found) = simulation.settled_parameter().filter(|_| !self.has_found) else { return Ok(()) };
        self.has_found = true;
        let (text, step) = (self.scene.text(), simulation.clock().step());
        let with = Scene::parse(text, "the scene with what was found", &[found.setting()])?;
        self.scene = self.scene.clone().changed(with.text(), &self.output, step);
        let kept = if self.comm.is_first() { self.folder.keep(with.text()) } else { Ok(()) };
        Ok(self.comm.agree(kept.map_err(|e| in_full(&e)))?)
    }

    fn frame(&mut self, simulation: &dyn Simulation) -> Result<(), RunError> {
        let frame = simulation.frame_share();
        let clock = (simulation.clock().step(), simulation.clock().time());
        let mut trajectory = self.files.trajectory.as_mut();
        let append = |rows: &ById| trajectory.as_mut().map_or(Ok(()), |file| file.append_for(clock, rows, &frame.cell));
        Ok(self.comm.agree(frame.particles.by_id(&self.comm, append).unwrap_or(Ok(())))?)
    }

    fn row(&mut self, simulation: &mut dyn Simulation) -> Result<(), RunError> {
        let row = simulation.observe();
        let clock = (simulation.clock().step(), simulation.clock().time());
        let append = |file: &mut Series| file.append(clock, &row);
        Ok(self.comm.agree(self.files.series.as_mut().map_or(Ok(()), append))?)
    }

    /// Longest time that a checkpoint took.
    pub fn longest_checkpoint(&self) -> Duration {
        self.longest_checkpoint
    }

    /// Writes a checkpoint, unless there is one of this step already, and the averages so far. The last checkpoint of
    /// a run is written after everything else: a run that has it is finished.
    pub fn checkpoint(&mut self, simulation: &mut dyn Simulation) -> Result<(), RunError> {
        let step = simulation.clock().step();
        if self.saved == Some(step) {
            return Ok(());
        }
        let began = Instant::now();
        if step == self.last {
            self.conclude(simulation)?;
            self.state(simulation)?;
        } else {
            self.state(simulation)?;
            self.averages(simulation)?;
        }
        self.longest_checkpoint = self.longest_checkpoint.max(began.elapsed());
        Ok(())
    }

    /// Writes the answers and the last checkpoint of a run that has ended. Returns the answers on the first rank.
    /// Collective.
    pub fn finish(&mut self, simulation: &mut dyn Simulation) -> Result<&[RunAnswer], RunError> {
        self.conclude(simulation)?;
        self.checkpoint(simulation)?;
        Ok(self.answers.as_deref().unwrap_or_default())
    }

    /// Writes averages and answers, once. Answers that cannot be computed, since a file cannot be read, are an error.
    fn conclude(&mut self, simulation: &mut dyn Simulation) -> Result<(), RunError> {
        if self.answers.is_none() {
            self.averages(simulation)?;
            let answers = if self.comm.is_first() { self.find_answers() } else { Ok(Vec::new()) };
            let answers = self.comm.agree(answers)?;
            let write = match &answers[..] {
                [] => Ok(()),
                answers => write_answers(answers, self.folder.manifest()).map(drop),
            };
            self.comm.agree(write)?;
            self.answers = Some(answers);
        }
        Ok(())
    }

    fn find_answers(&self) -> Result<Vec<RunAnswer>, String> {
        let scene = Scene::parse(self.scene.text(), "the scene of the run", &[]).map_err(|e| in_full(&e))?;
        run_answers(self.folder(), &scene, &AnswerRange::of_scene(&scene)).map_err(|e| in_full(&e))
    }

    /// Rewrites the checkpoint of this step for a scene that has changed.
    pub(super) fn renew_checkpoint(&mut self, simulation: &mut dyn Simulation) -> Result<(), RunError> {
        self.saved = None;
        self.checkpoint(simulation)
    }

    fn field(&self, simulation: &mut dyn Simulation) -> Result<(), RunError> {
        let field = simulation.velocity_field()?.filter(|_| self.comm.is_first());
        let write = field.map_or(Ok(()), |field| write_field(&field, self.folder.manifest(), &self.provenance));
        Ok(self.comm.agree(write)?)
    }

    fn contacts(&self, simulation: &dyn Simulation) -> Result<(), RunError> {
        let contacts = simulation.contact_forces().filter(|_| self.comm.is_first());
        let write = contacts.map_or(Ok(()), |list| write_contacts(&list, self.folder.manifest(), &self.provenance));
        Ok(self.comm.agree(write)?)
    }

    fn state(&mut self, simulation: &mut dyn Simulation) -> Result<(), RunError> {
        let state = simulation.state();
        // Data that precede a checkpoint must be on the disk before it.
        let is_whole = || self.files.sync().and_then(|()| self.folder.check_scene());
        self.comm.agree(if self.comm.is_first() { is_whole() } else { Ok(()) })?;
        self.comm.agree(Checkpoints::write(self.folder.manifest(), &state, &self.scene, &self.comm))?;
        self.saved = Some(simulation.clock().step());
        Ok(())
    }

    fn averages(&self, simulation: &mut dyn Simulation) -> Result<(), RunError> {
        let path = self.folder.path();
        let write = simulation.averages().map_or(Ok(()), |set| {
            let folder = set.folder.map_or_else(|| path.to_owned(), |name| path.join(name));
            write_tables(&folder, set.name, &self.provenance, &set.tables, self.folder.manifest())
        });
        Ok(self.comm.agree(write)?)
    }
}

/// Provenance of the results of a scene.
pub fn provenance(scene: &Scene, plan: String, comm: &Comm) -> Provenance {
    Provenance {
        scene: scene.text().to_owned(),
        program: concat!("fcm-solve ", env!("CARGO_PKG_VERSION")).to_owned(),
        plan,
        ranks: comm.size(),
        seed: scene.kind().seed(),
    }
}
