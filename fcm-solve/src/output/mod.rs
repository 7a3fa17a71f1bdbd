//! What a run leaves behind.

mod averages;
mod folder;
mod observe;
mod rheology;

use crate::suspension::{ANGULAR_VELOCITY, STRESSLET, Suspension};
use averages::Averages;
use domain::Comm;
pub use folder::Folder;
use io::{FileError, Kind, Output, Provenance, Scene, Series, Trajectory, VelocityField, drop_fields_after};
use observe::Observer;
use std::path::Path;

/// Writes what is due, when it is due. The first rank writes; every call is collective.
pub struct Recorder {
    folder: Folder,
    output: Output,
    provenance: Provenance,
    observer: Observer,
    averages: Option<Averages>,
    files: Files,
    comm: Comm,
    /// The first step that is recorded: those before are in the files already.
    from: u64,
    /// The step of the last checkpoint.
    saved: Option<u64>,
}

/// The files that grow: on the first rank, and if they are ever due.
#[derive(Default)]
struct Files {
    trajectory: Option<Trajectory>,
    series: Option<Series>,
}

/// The columns of a frame of the trajectory.
const FRAME: [&str; 3] = [crate::integrator::VELOCITY, ANGULAR_VELOCITY, STRESSLET];

impl Recorder {
    /// A recorder for a run from its start, in place of any former run in the folder.
    pub fn create(folder: Folder, scene: &Scene, suspension: &mut Suspension) -> anyhow::Result<Self> {
        let comm = suspension.comm().clone();
        let emptied = if comm.is_first() { folder.start_with(scene.text()) } else { Ok(()) };
        comm.agree(emptied.map_err(|e| crate::run::in_full(&e)))?;
        Self::open(folder, scene, suspension, None)
    }

    /// A recorder for a run that goes on from where the suspension is, with what its statistics have taken in, on the first
    /// rank.
    pub fn resume(
        folder: Folder,
        scene: &Scene,
        suspension: &mut Suspension,
        statistics: &[u8],
    ) -> anyhow::Result<Self> {
        let last = suspension.clock().step();
        let mut recorder = Self::open(folder, scene, suspension, Some(last))?;
        let taken_up = recorder.averages.as_mut().map_or(Ok(()), |averages| averages.take_up(statistics));
        recorder.comm.agree(taken_up)?;
        Ok(recorder)
    }

    fn open(folder: Folder, scene: &Scene, suspension: &mut Suspension, last: Option<u64>) -> anyhow::Result<Self> {
        let comm = suspension.comm().clone();
        let Kind::Suspension(checked) = scene.kind() else { unreachable!("a suspension has a scene of its kind") };
        let provenance = Provenance {
            scene: scene.text().to_owned(),
            program: concat!("fcm-solve ", env!("CARGO_PKG_VERSION")).to_owned(),
            plan: suspension.plan(),
            ranks: comm.size(),
            seed: checked.seed,
        };
        let observer = Observer::new(checked, suspension.clock().step());
        let output = checked.output.clone();
        let frame = suspension.gathered(Some(&FRAME));
        let open = Open { path: folder.path(), provenance: &provenance, last, steps: checked.time.steps };
        let files = if comm.is_first() { open.files(&output, &frame, &observer) } else { Ok(Files::default()) };
        let files = comm.agree(files)?;
        let from = last.map_or(0, |step| step + 1);
        let averages = checked.statistics.map(|wanted| Averages::new(checked, wanted, &frame));
        Ok(Self { folder, output, provenance, observer, averages, files, comm, from, saved: last })
    }

    /// The folder of the results.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Writes what is due at the step where the suspension is.
    pub fn record(&mut self, suspension: &mut Suspension) -> anyhow::Result<()> {
        let step = suspension.clock().step();
        if step < self.from {
            return Ok(());
        }
        if self.output.trajectory.is_due(step) {
            self.frame(suspension)?;
        }
        if self.output.observables.is_due(step) {
            self.row(suspension)?;
        }
        if self.output.fields.is_due(step) {
            self.field(suspension)?;
        }
        if let Some(averages) = &mut self.averages {
            averages.sample(suspension);
        }
        if self.output.checkpoints.is_due(step) {
            self.checkpoint(suspension)?;
        }
        Ok(())
    }

    fn frame(&mut self, suspension: &Suspension) -> anyhow::Result<()> {
        let particles = suspension.gathered(Some(&FRAME));
        let clock = (suspension.clock().step(), suspension.clock().time());
        let append = |file: &mut Trajectory| file.append(clock, suspension.cell(), &particles);
        Ok(self.comm.agree(self.files.trajectory.as_mut().map_or(Ok(()), append))?)
    }

    fn row(&mut self, suspension: &mut Suspension) -> anyhow::Result<()> {
        let row = self.observer.observe(suspension);
        let clock = (suspension.clock().step(), suspension.clock().time());
        let append = |file: &mut Series| file.append(clock, &row);
        Ok(self.comm.agree(self.files.series.as_mut().map_or(Ok(()), append))?)
    }

    fn field(&mut self, suspension: &mut Suspension) -> anyhow::Result<()> {
        let (points, values) = suspension.velocity_field();
        let field = VelocityField {
            step: suspension.clock().step(),
            time: suspension.clock().time(),
            cell: *suspension.cell(),
            points,
            values: &values,
            note: "relative to the background flow",
        };
        let first = self.comm.is_first();
        let written = if first { field.write(self.folder.path(), &self.provenance) } else { Ok(()) };
        Ok(self.comm.agree(written)?)
    }

    /// Writes a checkpoint and what statistics have come to, unless there is a checkpoint of this step already.
    pub fn checkpoint(&mut self, suspension: &mut Suspension) -> anyhow::Result<()> {
        let step = suspension.clock().step();
        if self.saved == Some(step) {
            return Ok(());
        }
        let mut checkpoint = suspension.checkpoint();
        checkpoint.statistics = self.averages.as_mut().map(Averages::state).unwrap_or_default();
        let write = || {
            checkpoint.write(self.folder.path())?;
            self.averages.as_ref().map_or(Ok(()), |averages| averages.write(self.folder.path(), &self.provenance))
        };
        let written = if self.comm.is_first() { write() } else { Ok(()) };
        self.comm.agree(written)?;
        self.saved = Some(step);
        Ok(())
    }
}

/// How files are opened: from the start, or after the last step of a former run.
struct Open<'a> {
    path: &'a Path,
    provenance: &'a Provenance,
    last: Option<u64>,
    steps: u64,
}

impl Open<'_> {
    fn files(&self, output: &Output, frame: &domain::Particles, observer: &Observer) -> Result<Files, FileError> {
        if let Some(last) = self.last {
            drop_fields_after(self.path, last)?;
        }
        let frames = output.trajectory.count_until(self.steps);
        let rows = output.observables.count_until(self.steps);
        Ok(Files {
            trajectory: if frames > 0 { Some(self.trajectory(frame, frames)?) } else { None },
            series: if rows > 0 { Some(self.series(observer, rows)?) } else { None },
        })
    }

    fn trajectory(&self, frame: &domain::Particles, frames: u64) -> Result<Trajectory, FileError> {
        let path = self.path.join("trajectory.h5");
        match self.last {
            Some(last) if path.exists() => Trajectory::resume(&path, self.provenance, frame, (last, frames)),
            _ => Trajectory::create(&path, self.provenance, frame, frames),
        }
    }

    fn series(&self, observer: &Observer, rows: u64) -> Result<Series, FileError> {
        let quantities = observer.quantities();
        match self.last {
            Some(last) if self.path.join("observables.h5").exists() => {
                Series::resume(self.path, self.provenance, &quantities, (last, rows))
            }
            _ => Series::create(self.path, self.provenance, &quantities, rows),
        }
    }
}
