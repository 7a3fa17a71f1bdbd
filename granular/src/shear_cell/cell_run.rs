//! A run of grains in a shear cell as a simulation whose steps are the intervals of observation.

use super::tables::{WALLS, tables};
use super::{CellModel, CellSample, CollisionDetection, Grains, Sampling, ShearCell, Side};
use crate::GrainStartError;
use domain::{Comm, Interrupt, Number, Particles, PeriodicBox, Vector};
use simulation::{
    Clock, Frame, Outline, Quantity, Rearrangement, RearrangementError, Simulation, SimulationError, State, TableSet,
};

/// A cell and the parameters of its run.
#[derive(Debug, Clone, Copy)]
pub struct Experiment {
    /// The cell, its walls and its grains.
    pub model: CellModel,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of grains.
    pub count: usize,
    /// Standard deviation of each velocity component at the start.
    pub agitation: f64,
    /// Method of collision detection.
    pub collisions: CollisionDetection,
    /// Averages to measure; the grains are sampled at each step.
    pub sampling: Sampling,
    /// Number of steps before measuring.
    pub transient: u64,
    /// Interval of observation.
    pub time_step: f64,
    /// Last step.
    pub steps: u64,
}

impl Experiment {
    /// Summary of the cell in words and numbers.
    pub fn outline(&self) -> Outline {
        let fraction = self.model.solid_fraction(self.count, self.model.edges().y);
        let engine = match self.collisions {
            CollisionDetection::EventDriven => "at their exact times".to_owned(),
            CollisionDetection::TimeStepped { step } => format!("on a time step of {:.6}", Number(step)),
        };
        let [end, from] = [self.steps, self.transient].map(|steps| steps as f64 * self.time_step);
        let steps = format!("{}, until time {:.6}; measured from time {:.6}", self.steps, Number(end), Number(from));
        Outline::default()
            .line("grains", format_args!("{}, solid fraction {:.4}", self.count, Number(fraction)))
            .line("top", if self.model.is_top_wall_free() { "free under its load" } else { "fixed" })
            .line("collisions", engine)
            .line("steps", steps)
            .value("particles", self.count)
            .value("solid_fraction", fraction)
            .value("steps", self.steps)
            .value("end_time", end)
            .value("measured_from", from)
            .warnings(self.caution())
    }

    /// A warning if nothing is measured until the end of the run.
    fn caution(&self) -> Option<String> {
        let [end, from] = [self.steps, self.transient].map(|steps| Number(steps as f64 * self.time_step));
        (self.transient > 0 && self.transient >= self.steps).then(|| {
            format!(
                "time.transient = {from:.6}, but the run ends at time {end:.6}: nothing is measured, and there will be \
                 no profiles unless the run goes on for longer"
            )
        })
    }
}

/// Error of grains without room to move.
#[derive(Debug, thiserror::Error)]
#[error(
    "the grains jam at time {:.6}: rigid grains without room to move hit each other without end; lower {}, or take \
     collisions = \"time-stepped\"",
    Number(*time),
    if *top_wall_is_free { "top.pressure" } else { "grains.solid_fraction, let the top go with top.kind = \"free\"" }
)]
struct Jammed {
    time: f64,
    top_wall_is_free: bool,
}

/// A run of the shear cell. A step is an interval of observation.
pub struct CellRun {
    experiment: Experiment,
    run: ShearCell,
    clock: Clock,
    sample: Option<CellSample>,
    interrupt: Interrupt,
    comm: Comm,
}

impl CellRun {
    /// An experiment at time zero: grains packed at random, with random velocities. `tell` is called from time to time
    /// with the completed fraction of the packing.
    pub fn start(experiment: &Experiment, comm: &Comm, tell: &mut dyn FnMut(f64)) -> Result<Self, GrainStartError> {
        GrainStartError::unless_alone(comm)?;
        let Experiment { model, seed, count, agitation, collisions, sampling, .. } = *experiment;
        let mut grains = model.pack_with_progress(count, seed, tell)?;
        grains.set_velocities(&model, agitation, seed);
        Ok(Self::of(experiment, ShearCell::new(&model, &grains, collisions, sampling)?, 0, comm))
    }

    /// An experiment in the state of a checkpoint.
    pub fn resume(experiment: &Experiment, state: &State, comm: &Comm) -> Result<Self, GrainStartError> {
        GrainStartError::unless_alone(comm)?;
        let Experiment { model, collisions, sampling, .. } = experiment;
        let grains = Grains::from_particles(model, &state.particles)?;
        let run = ShearCell::resume(model, &grains, *collisions, *sampling, &state.statistics.concat())?;
        Ok(Self::of(experiment, run, state.step, comm))
    }

    fn of(experiment: &Experiment, run: ShearCell, step: u64, comm: &Comm) -> Self {
        Self {
            experiment: *experiment,
            run,
            clock: Clock::at(step, experiment.time_step),
            sample: None,
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
        self.experiment.outline().text().to_owned()
    }

    fn listen(&mut self, interrupt: Interrupt) {
        self.interrupt = interrupt;
    }

    fn start_warnings(&self) -> Vec<String> {
        self.experiment.caution().into_iter().collect()
    }

    /// Takes one step. The engine is restarted after each step, as from a checkpoint, so that the results of a run do
    /// not depend on interruptions; an interrupted step is discarded.
    fn advance(&mut self, _last: u64) -> Result<(), SimulationError> {
        let before = *self.run.engine().tally();
        let may_continue = || !self.interrupt.is_requested();
        let is_transient = self.clock.step() < self.experiment.transient;
        let take = if is_transient { ShearCell::run_transient } else { ShearCell::measure };
        let is_taken = take(&mut self.run, self.clock.dt(), &may_continue);
        if let Some(failure) = self.run.engine().failure() {
            return Err(SimulationError::new(failure));
        }
        if self.run.engine().is_jammed() {
            let (time, top_wall_is_free) = (self.run.engine().tally().time, self.experiment.model.is_top_wall_free());
            return Err(SimulationError::new(Jammed { time, top_wall_is_free }));
        }
        if !is_taken {
            return self.run.return_to_restart().map_err(SimulationError::new);
        }
        self.run.restart().map_err(SimulationError::new)?;
        self.sample = Some(self.run.sample_since(&before));
        self.clock.tick();
        Ok(())
    }

    fn frame(&self) -> Frame {
        let engine = self.run.engine();
        let edges = Vector { y: engine.top_wall().height, ..self.experiment.model.edges() };
        let cell = PeriodicBox::new(edges).expect("a cell's edges are positive");
        Frame { particles: engine.grains().to_particles(&self.experiment.model), cell, periodic: [true, false, false] }
    }

    fn quantities(&self) -> Vec<Quantity> {
        let stress = Quantity {
            name: "wall_stress".into(),
            unit: "force/length^2",
            table: Some((WALLS.map(String::from).to_vec(), ["normal", "along", "across"].map(String::from).to_vec())),
        };
        let numbers = CellSample::COLUMNS.iter().map(|(name, unit)| Quantity::number(name, unit));
        [stress].into_iter().chain(numbers).collect()
    }

    /// Stresses are averages over the last step; at the start they are NaN.
    fn observe(&mut self) -> Vec<Vec<f64>> {
        let none = *self.run.engine().tally();
        let sample = self.sample.unwrap_or_else(|| self.run.sample_since(&none));
        let stresses = Side::ALL.iter().flat_map(|&side| sample.stresses[side as usize]).collect();
        [stresses].into_iter().chain(sample.values.map(|value| vec![value])).collect()
    }

    fn state(&mut self) -> State {
        State {
            step: self.clock.step(),
            strain: 0.0,
            plan: self.plan(),
            particles: self.run.engine().grains().to_particles(&self.experiment.model),
            statistics: vec![self.run.save()],
        }
    }

    fn rearranged(&self, mut state: State, change: &Rearrangement) -> Result<State, SimulationError> {
        if !change.radii.is_empty() {
            return Err(SimulationError::new(RearrangementError::FixedRadii));
        }
        let grains = |particles: &Particles| {
            Grains::from_particles(&self.experiment.model, particles).map_err(SimulationError::new)
        };
        let before = grains(&state.particles)?;
        change.put_motions(&mut state.particles);
        let after = grains(&state.particles)?;
        let saved =
            self.run.saved_with_grains(&state.statistics.concat(), [&before, &after]).ok_or(GrainStartError::State);
        Ok(State { statistics: vec![saved.map_err(SimulationError::new)?], ..state })
    }

    fn averages(&mut self) -> Option<TableSet> {
        let is_measured = self.clock.step() > self.experiment.transient;
        is_measured.then(|| TableSet { folder: None, name: "averages", tables: tables(&self.run.report()) })
    }

    fn warnings(&self) -> Vec<String> {
        self.run.report().warnings
    }
}
