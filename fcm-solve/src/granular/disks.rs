//! Sheared disks as the march and the recorder see them.

use super::{memory, on_one_rank, outline};
use crate::clock::Clock;
use crate::preparing::Preparing;
use crate::simulation::Simulation;
use anyhow::Context;
use domain::{Comm, Particles};
use drivers::disks::{AveragedProfile, Disks, MeanStripe, Model, Progress, Record, Stage};
use io::{Checkpoint, FileError, Frame, GranularDisksScene, Placed, Provenance, Quantity, Table, write_tables};
use statistics::{State, Store};
use std::path::Path;

/// Disks that are moved by one call at most, times steps: a moment, after which a signal is heard.
const MOMENT: u64 = 1_000_000;

/// A run of sheared disks. Its steps are those of the flow; what makes a random start ready comes before the first.
pub struct DiskRun {
    disks: Disks,
    clock: Clock,
    profile: AveragedProfile,
    plan: String,
    comm: Comm,
}

/// What a checkpoint keeps besides the disks.
struct Kept {
    progress: Vec<f64>,
    profile: AveragedProfile,
}

impl State for Kept {
    fn visit(&mut self, store: &mut dyn Store) {
        store.numbers(&mut self.progress);
        self.profile.visit(store);
    }
}

impl DiskRun {
    /// A scene when the flow sets in.
    pub fn start(scene: &GranularDisksScene, comm: &Comm) -> anyhow::Result<Self> {
        on_one_rank(comm)?;
        let disks = match &scene.start {
            None => {
                let mut progress = Preparing::start(comm, "the disks settle");
                Disks::prepare_and_tell(&scene.model, &mut |done| progress.show(done))?
            }
            Some(path) => flowing(scene, &placed(path)?, comm).with_context(|| path.display().to_string())?,
        };
        Ok(Self::of(scene, disks, AveragedProfile::new(scene.profile_strips), comm))
    }

    /// A scene as a checkpoint has it.
    pub fn resume(scene: &GranularDisksScene, checkpoint: &Checkpoint, comm: &Comm) -> anyhow::Result<Self> {
        on_one_rank(comm)?;
        let mut kept = Kept { progress: Vec::new(), profile: AveragedProfile::new(scene.profile_strips) };
        let fits = kept.load(&checkpoint.statistics);
        let progress = Progress::from_numbers(&kept.progress).filter(|_| fits);
        let progress = progress.context("the checkpoint has no progress of disks; start the run anew")?;
        let model = match scene.start {
            None => scene.model.clone(),
            Some(_) => Model::with_particles(scene.model.parameters().clone(), &checkpoint.particles)?,
        };
        Ok(Self::of(scene, Disks::resume(&model, &checkpoint.particles, &progress)?, kept.profile, comm))
    }

    fn of(scene: &GranularDisksScene, disks: Disks, profile: AveragedProfile, comm: &Comm) -> Self {
        debug_assert!(disks.stage() == Stage::Flow, "checkpoints are written in the flow");
        let clock = Clock::at(disks.steps(), scene.time.step);
        let plan = outline::disks(disks.model(), &scene.time);
        Self { disks, clock, profile, plan, comm: comm.clone() }
    }
}

/// Disks that a file has placed, if there is memory for them.
fn flowing(scene: &GranularDisksScene, particles: &Particles, comm: &Comm) -> anyhow::Result<Disks> {
    let model = Model::with_particles(scene.model.parameters().clone(), particles)?;
    let disks = particles.len();
    let fits = comm.check_room(memory::of_disks(&model, scene.profile_strips));
    fits.with_context(|| format!("particles.path brings {disks} disks; bring fewer"))?;
    Ok(Disks::flowing(model.parameters().clone(), particles)?)
}

/// The disks of a file, moving with the liquid.
fn placed(path: &Path) -> anyhow::Result<Particles> {
    let Placed { positions, radii, species } = Placed::read(path)?;
    let mut particles = Particles::default();
    for (id, position) in positions.iter().enumerate() {
        let radius = radii.as_ref().map_or(1.0, |radii| radii[id]);
        particles.push(id as u64, *position, radius, species.as_ref().map_or(0, |species| species[id]));
    }
    Ok(particles)
}

impl Simulation for DiskRun {
    fn comm(&self) -> &Comm {
        &self.comm
    }

    fn clock(&self) -> &Clock {
        &self.clock
    }

    fn plan(&mut self) -> String {
        self.plan.clone()
    }

    fn advance(&mut self, last: u64) -> anyhow::Result<()> {
        let moment = (MOMENT / self.disks.model().sizes().len() as u64).max(1);
        self.disks.advance(moment.min(last - self.clock.step()));
        self.disks.check()?;
        self.clock = Clock::at(self.disks.steps(), self.clock.dt());
        Ok(())
    }

    fn frame(&self) -> Frame {
        let (particles, _) = self.disks.store();
        Frame { particles, cell: self.disks.cell(), periodic: [true, true, false] }
    }

    fn quantities(&self) -> Vec<Quantity> {
        Record::COLUMNS.iter().map(|(name, unit)| Quantity::number(name, unit)).collect()
    }

    /// What is averaged is so since the row before. The profile is taken at each row.
    fn observe(&mut self) -> Vec<Vec<f64>> {
        self.profile.add(&self.disks.snapshot());
        let record = self.disks.record();
        self.disks.restart_tally();
        record.values().map(|value| vec![value]).to_vec()
    }

    fn checkpoint(&mut self) -> anyhow::Result<Checkpoint> {
        let (particles, progress) = self.disks.store();
        Ok(Checkpoint {
            step: self.clock.step(),
            strain: self.disks.cell().strain(),
            plan: self.plan.clone(),
            particles,
            statistics: Kept { progress: progress.to_numbers(), profile: self.profile.clone() }.save(),
        })
    }

    fn write_averages(&mut self, folder: &Path, provenance: &Provenance) -> Result<(), FileError> {
        let mut table = Table::new("profile", &[], &[("height", "length"), ("disks", "")]);
        for (name, unit) in PROFILE {
            table.columns.extend([(name.to_owned(), unit), (format!("{name}_error"), unit)]);
        }
        for MeanStripe { height, count, velocity, excess, temperature } in self.profile.strips() {
            let [v, w, t] = [velocity, excess, temperature].map(|e| [e.mean, e.error]);
            table.add(&[], &[&[height, count.mean], &v[..], &w, &t].concat());
        }
        write_tables(folder, "averages", provenance, &[table])
    }
}

/// What is averaged over a strip.
const PROFILE: [(&str, &str); 3] =
    [("velocity", "length/time"), ("excess_velocity", "length/time"), ("temperature", "length^2/time^2")];
