//! A run of the shear cell: one of the two engines, and its measurements.

use super::{
    Balance, CellModel, CellSample, CellState, CellTally, CollisionDetection, DensityMap, Engine, Grains, Layer, Side,
    WallStress, measure::Measurements,
};
use crate::parameter::{ParameterError, positive, require};
use domain::Number;
use statistics::{Estimate, State as _, Store};

/// Quantities and intervals of sampling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Time over which wall stresses are averaged; the paper's is 0.05 ms.
    pub window: f64,
    /// Windows between two samples of the profiles and the map.
    pub every: u64,
    /// Number of layers of the profiles.
    pub layers: usize,
    /// Pixels of the map along z and y.
    pub pixels: [usize; 2],
}

impl Default for Sampling {
    fn default() -> Self {
        Self { window: 5e-5, every: 20, layers: 50, pixels: [95, 20] }
    }
}

impl Sampling {
    /// Refuses counts of zero, and a window that the engine cannot measure.
    pub fn check(&self, collisions: CollisionDetection) -> Result<(), ParameterError> {
        positive("measure.window", self.window)?;
        require(self.every > 0, "measure.every", self.every, "at least 1")?;
        require(self.layers > 0, "measure.layers", self.layers, "at least 1")?;
        let pixels = self.pixels;
        let some = pixels[0] > 0 && pixels[1] > 0;
        require(some, "measure.pixels", format_args!("{pixels:?}"), "at least 1 along each edge")?;
        let CollisionDetection::TimeStepped { step } = collisions else { return Ok(()) };
        positive("time.collision_step", step)?;
        let steps = self.window / step;
        let whole = steps >= 0.5 && (steps - steps.round()).abs() < 1e-6 * steps;
        require(
            whole,
            "measure.window",
            Number(self.window),
            format_args!("a whole number of time steps of {}", Number(step)),
        )
    }
}

/// A run with its measurements.
pub struct ShearCell {
    model: CellModel,
    engine: Box<Engine>,
    sampling: Sampling,
    measured: Measurements,
    /// The last restart of the engine.
    mark: Mark,
}

/// State and measurements at one time. A checkpoint keeps them, with the grains in its particle store.
#[derive(Clone)]
struct Mark {
    state: CellState,
    measured: Measurements,
}

impl statistics::State for Mark {
    fn visit(&mut self, store: &mut dyn Store) {
        self.state.top_wall.visit(store);
        self.state.tally.visit(store);
        self.measured.visit(store);
    }
}

/// The results of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct CellReport {
    /// Duration of the measurements.
    pub measured: f64,
    /// Stress on each wall.
    pub walls: [WallStress; 4],
    /// Height of the top wall.
    pub height: Estimate,
    /// Solid fraction under that height.
    pub solid_fraction: f64,
    /// Granular temperature relative to the profile.
    pub temperature: f64,
    /// Profiles from the bottom up.
    pub layers: Vec<Layer>,
    /// Map of the solid fraction across the cell.
    pub map: DensityMap,
    /// Balances of the whole run.
    pub balance: Balance,
    /// Sums over the whole run.
    pub tally: CellTally,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// Largest overlap, over the diameter, that needs no warning.
const OVERLAP: f64 = 0.02;
/// Largest relative error of the balances of energy and momentum that round-off explains.
const UNBALANCED: f64 = 1e-9;

impl ShearCell {
    /// Starts a run.
    pub fn new(
        model: &CellModel,
        grains: &Grains,
        collisions: CollisionDetection,
        sampling: Sampling,
    ) -> Result<Self, ParameterError> {
        sampling.check(collisions)?;
        let engine = Engine::new(model, grains, collisions)?;
        // A free top wall may rise.
        let height = model.parameters().height * if model.is_top_wall_free() { 1.25 } else { 1.0 };
        let measured = Measurements::new(model, &*engine, height, &sampling);
        let mark = Mark { state: CellState::new(model, grains), measured: measured.clone() };
        Ok(Self { model: *model, engine, sampling, measured, mark })
    }

    /// Runs for a duration without measuring, while the grains are not jammed and `may_continue` returns true. Returns
    /// whether it reached the end.
    pub fn run_transient(&mut self, duration: f64, may_continue: &dyn Fn() -> bool) -> bool {
        self.engine.advance(duration, may_continue)
    }

    /// Like [`ShearCell::run_transient`], but measures, for the nearest whole number of windows.
    pub fn measure(&mut self, duration: f64, may_continue: &dyn Fn() -> bool) -> bool {
        for _ in 0..(duration / self.sampling.window).round() as u64 {
            let before = *self.engine.tally();
            if !may_continue() || !self.engine.advance(self.sampling.window, may_continue) {
                return false;
            }
            self.measured.add(&self.model, &*self.engine, &before, &self.sampling);
        }
        true
    }

    /// Restarts the engine from the present state, as a resumed run does.
    pub fn restart(&mut self) -> Result<(), ParameterError> {
        self.mark = Mark { state: self.engine.checkpoint(&self.model)?, measured: self.measured.clone() };
        Ok(())
    }

    /// Returns to the last restart of the engine.
    pub fn return_to_restart(&mut self) -> Result<(), ParameterError> {
        self.engine = Engine::resume(&self.model, &self.mark.state, self.engine.collisions())?;
        self.measured = self.mark.measured.clone();
        Ok(())
    }

    /// State of a checkpoint apart from the grains. A run whose engine was restarted and one that is resumed
    /// continue with the same bits.
    pub fn save(&self) -> Vec<u8> {
        Mark { state: self.engine.state(), measured: self.measured.clone() }.save()
    }

    /// The saved part of a checkpoint, for other grains than it was saved with: the balances do not count what the user
    /// has done. None if it is of another form.
    pub fn saved_with_grains(&self, saved: &[u8], [before, after]: [&Grains; 2]) -> Option<Vec<u8>> {
        let mut mark = self.mark.clone();
        mark.load(saved).then(|| {
            mark.measured.start = mark.measured.start.with_replaced(&self.model, [before, after]);
            mark.save()
        })
    }

    /// Goes on from the grains of a checkpoint and what was saved there; the rest as for a new run.
    pub fn resume(
        model: &CellModel,
        grains: &Grains,
        collisions: CollisionDetection,
        sampling: Sampling,
        saved: &[u8],
    ) -> Result<Self, ParameterError> {
        let mut run = Self::new(model, grains, collisions, sampling)?;
        require(run.mark.load(saved), "checkpoint", "of another form", "what a run of this scene keeps")?;
        run.return_to_restart()?;
        Ok(run)
    }

    /// The engine.
    pub fn engine(&self) -> &Engine {
        &*self.engine
    }

    /// The present state of the cell, and averages since an earlier tally.
    pub fn sample_since(&self, before: &CellTally) -> CellSample {
        CellSample::of(&self.model, &*self.engine, before, self.measured.start.balance(&self.model, &*self.engine))
    }

    /// The results so far; stresses and profiles are averages over the time measured.
    pub fn report(&self) -> CellReport {
        let (model, tally, measured) = (&self.model, *self.engine.tally(), &self.measured);
        let height = measured.heights.estimate();
        let balance = measured.start.balance(model, &*self.engine);
        CellReport {
            measured: measured.windows() as f64 * self.sampling.window,
            walls: Side::ALL.map(|side| measured.wall(side)),
            height,
            solid_fraction: model.solid_fraction(self.engine.grains().len(), height.mean),
            temperature: measured.profile.temperature(),
            layers: measured.profile.layers(),
            map: measured.map.clone(),
            balance,
            tally,
            warnings: warnings(&tally, &balance),
        }
    }
}

fn warnings(tally: &CellTally, balance: &Balance) -> Vec<String> {
    let overlap = (tally.largest_overlap > OVERLAP).then(|| {
        format!(
            "the largest overlap was {:.1} % of a diameter ({:.2} % on average over hits): the stresses depend on how \
             overlaps are treated; take a smaller time step, a lower solid fraction or the event-driven engine",
            100.0 * tally.largest_overlap,
            100.0 * tally.mean_overlap()
        )
    });
    let lost = [("energy", balance.energy), ("momentum", balance.momentum)];
    let unbalanced = lost.into_iter().filter(|(_, left)| left.is_nan() || *left >= UNBALANCED).map(|(what, left)| {
        let off =
            if left.is_finite() { format!("{left:.1e} of what went through it") } else { "any amount".to_owned() };
        format!("the balance of {what} is off by {off}: this is an error of the program")
    });
    overlap.into_iter().chain(unbalanced).collect()
}
