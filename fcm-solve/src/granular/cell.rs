//! Grains in a shear cell as the march and the recorder see them.

use super::cell_tables::{WALLS, tables};
use super::{on_one_rank, outline};
use crate::clock::Clock;
use crate::preparing::Preparing;
use crate::simulation::Simulation;
use anyhow::ensure;
use domain::{Comm, Interrupt, Number, PeriodicBox, Vector};
use drivers::shear_cell::{Grains, Model, Run, Sample, Side};
use io::{Checkpoint, FileError, Frame, Provenance, Quantity, ShearCellScene, write_tables};
use std::path::Path;

/// A run of the shear cell. A step is the time from one look at the grains to the next.
pub struct CellRun {
    run: Run,
    model: Model,
    clock: Clock,
    settle: u64,
    sample: Option<Sample>,
    plan: String,
    interrupt: Interrupt,
    comm: Comm,
}

impl CellRun {
    /// A scene at time zero: grains packed at random and set moving.
    pub fn start(scene: &ShearCellScene, comm: &Comm) -> anyhow::Result<Self> {
        on_one_rank(comm)?;
        let mut progress = Preparing::start(comm, "the grains grow to their size");
        let mut grains = scene.model.pack_and_tell(scene.count, scene.seed, &mut |done| progress.show(done))?;
        drop(progress);
        grains.stir(&scene.model, scene.agitation, scene.seed);
        let run = Run::new(&scene.model, &grains, scene.collisions, scene.sampling)?;
        Ok(Self::of(scene, run, (0, comm)))
    }

    /// A scene as a checkpoint has it.
    pub fn resume(scene: &ShearCellScene, checkpoint: &Checkpoint, comm: &Comm) -> anyhow::Result<Self> {
        on_one_rank(comm)?;
        let grains = Grains::from_particles(&scene.model, &checkpoint.particles)?;
        let how = (scene.collisions, scene.sampling);
        let run = Run::resume(&scene.model, &grains, how, &checkpoint.statistics)?;
        Ok(Self::of(scene, run, (checkpoint.step, comm)))
    }

    fn of(scene: &ShearCellScene, run: Run, (step, comm): (u64, &Comm)) -> Self {
        let clock = Clock::at(step, scene.time.step);
        let plan = outline::cell(scene);
        Self {
            run,
            model: scene.model,
            clock,
            settle: scene.settle,
            sample: None,
            plan,
            interrupt: Interrupt::NEVER,
            comm: comm.clone(),
        }
    }
}

impl Simulation for CellRun {
    fn comm(&self) -> &Comm {
        &self.comm
    }

    fn clock(&self) -> &Clock {
        &self.clock
    }

    fn plan(&mut self) -> String {
        self.plan.clone()
    }

    fn listen(&mut self, interrupt: Interrupt) {
        self.interrupt = interrupt;
    }

    /// Takes one step. The engine starts anew after each, as it does from a checkpoint, so that a run is the same
    /// wherever it was interrupted; a step in which a signal comes is not taken.
    fn advance(&mut self, _last: u64) -> anyhow::Result<()> {
        let before = *self.run.engine().tally();
        let go_on = || !self.interrupt.is_requested();
        let is_settling = self.clock.step() < self.settle;
        let take = if is_settling { Run::settle } else { Run::measure };
        let is_taken = take(&mut self.run, self.clock.dt(), &go_on);
        if let Some(failure) = self.run.engine().failure() {
            return Err(failure.into());
        }
        ensure!(
            !self.run.engine().is_jammed(),
            "the grains jam at time {:.6}: rigid grains without room to move hit each other without end; lower {}, or take \
             collisions = \"time-stepped\"",
            Number(self.run.engine().tally().time),
            if self.model.is_lid_free() {
                "top.pressure"
            } else {
                "grains.solid_fraction, let the top go with top.kind = \"free\""
            }
        );
        if !is_taken {
            return Ok(self.run.go_back()?);
        }
        self.run.renew()?;
        self.sample = Some(self.run.sample_since(&before));
        self.clock.tick();
        Ok(())
    }

    fn frame(&self) -> Frame {
        let engine = self.run.engine();
        let edges = Vector { y: engine.lid().height, ..self.model.edges() };
        let cell = PeriodicBox::new(edges).expect("a cell's edges are positive");
        Frame { particles: engine.grains().to_particles(&self.model), cell, periodic: [true, false, false] }
    }

    fn quantities(&self) -> Vec<Quantity> {
        let stress = Quantity {
            name: "wall_stress",
            unit: "force/length^2",
            table: Some((WALLS.map(String::from).to_vec(), ["normal", "along", "across"].map(String::from).to_vec())),
        };
        let numbers = Sample::COLUMNS.iter().map(|(name, unit)| Quantity::number(name, unit));
        [stress].into_iter().chain(numbers).collect()
    }

    /// Stresses are averages over the last step; there are none at the start.
    fn observe(&mut self) -> Vec<Vec<f64>> {
        let none = *self.run.engine().tally();
        let sample = self.sample.unwrap_or_else(|| self.run.sample_since(&none));
        let stresses = Side::ALL.iter().flat_map(|&side| sample.stresses[side as usize]).collect();
        [stresses].into_iter().chain(sample.values().map(|value| vec![value])).collect()
    }

    fn checkpoint(&mut self) -> anyhow::Result<Checkpoint> {
        Ok(Checkpoint {
            step: self.clock.step(),
            strain: 0.0,
            plan: self.plan.clone(),
            particles: self.run.engine().grains().to_particles(&self.model),
            statistics: self.run.save(),
        })
    }

    fn write_averages(&mut self, folder: &Path, provenance: &Provenance) -> Result<(), FileError> {
        if self.clock.step() <= self.settle {
            return Ok(());
        }
        write_tables(folder, "averages", provenance, &tables(&self.run.report()))
    }

    fn warnings(&self) -> Vec<String> {
        self.run.report().warnings
    }
}
