//! Sheared disks as the march and the recorder see them.

use super::{from_bytes, on_one_rank, outline, to_bytes};
use crate::clock::Clock;
use crate::simulation::Simulation;
use anyhow::Context;
use domain::{Comm, Particles};
use drivers::disks::{Disks, Model, Progress, Record, Stage, Stripe};
use io::{Checkpoint, FileError, Frame, GranularDisksScene, Placed, Provenance, Quantity, Table, write_tables};
use std::path::Path;

/// Disks that are moved by one call at most, times steps: a moment, after which a signal is heard.
const MOMENT: u64 = 1_000_000;

/// A run of sheared disks. Its steps are those of the flow; what makes a random start ready comes before the first.
pub struct DiskRun {
    disks: Disks,
    clock: Clock,
    strips: usize,
    plan: String,
    comm: Comm,
}

impl DiskRun {
    /// A scene when the flow sets in.
    pub fn start(scene: &GranularDisksScene, comm: &Comm) -> anyhow::Result<Self> {
        on_one_rank(comm)?;
        let disks = match &scene.start {
            None => Disks::prepared(&scene.model),
            Some(path) => {
                let parameters = scene.model.parameters().clone();
                Disks::flowing(parameters, &placed(path)?).with_context(|| path.display().to_string())?
            }
        };
        Ok(Self::of(scene, disks, comm))
    }

    /// A scene as a checkpoint has it.
    pub fn resume(scene: &GranularDisksScene, checkpoint: &Checkpoint, comm: &Comm) -> anyhow::Result<Self> {
        on_one_rank(comm)?;
        let progress = Progress::from_numbers(&from_bytes(&checkpoint.statistics));
        let progress = progress.context("the checkpoint has no progress of disks; start the run anew")?;
        let model = match scene.start {
            None => scene.model.clone(),
            Some(_) => Model::with_particles(scene.model.parameters().clone(), &checkpoint.particles)?,
        };
        Ok(Self::of(scene, Disks::resume(&model, &checkpoint.particles, &progress)?, comm))
    }

    fn of(scene: &GranularDisksScene, disks: Disks, comm: &Comm) -> Self {
        debug_assert!(disks.stage() == Stage::Flow, "checkpoints are written in the flow");
        let clock = Clock::at(disks.steps(), scene.time.step);
        let plan = outline::disks(disks.model(), &scene.time);
        Self { disks, clock, strips: scene.profile_strips, plan, comm: comm.clone() }
    }
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

    /// What is averaged is so since the row before.
    fn observe(&mut self) -> Vec<Vec<f64>> {
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
            statistics: to_bytes(&progress.to_numbers()),
        })
    }

    fn write_averages(&mut self, folder: &Path, provenance: &Provenance) -> Result<(), FileError> {
        let units =
            [("height", "length"), ("disks", ""), ("velocity", "length/time"), ("excess_velocity", "length/time")];
        let temperature = ("temperature", "length^2/time^2");
        let mut table = Table::new("profile", &[], &[&units[..], &[temperature]].concat());
        for Stripe { height, count, velocity, excess, covariance, .. } in self.disks.snapshot().profile(self.strips) {
            let temperature = 0.5 * (covariance.x + covariance.z);
            table.add(&[], &[height, count as f64, velocity[0], excess, temperature]);
        }
        write_tables(folder, "averages", provenance, &[table])
    }
}
