//! A run of the shear cell: one of the two engines, and what is measured on the way.

use super::{
    Balance, Collisions, DensityMap, Engine, Estimate, Grains, Layer, Model, Profile, Sample, Side, State, Tally,
    WallStress,
    measure::{Start, estimate},
    numbers::Numbers,
};
use crate::parameter::{ParameterError, positive, require};
use domain::Vector;
use std::f64::consts::PI;

/// What is sampled, and how often.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Time over which wall stresses are averaged; the paper's is 0.05 ms.
    pub window: f64,
    /// Windows from one sample of the profiles and the map to the next.
    pub every: u64,
    /// Layers of the profiles.
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
    /// Refuses what can't be measured with an engine.
    pub fn check(&self, collisions: Collisions) -> Result<(), ParameterError> {
        positive("measure.window", self.window)?;
        require(self.every > 0, "measure.every", &self.every, "at least 1")?;
        require(self.layers > 0, "measure.layers", &self.layers, "at least 1")?;
        let pixels = self.pixels;
        let some = pixels[0] > 0 && pixels[1] > 0;
        require(some, "measure.pixels", &format!("{pixels:?}"), "at least 1 along each edge")?;
        let Collisions::TimeStepped { step } = collisions else { return Ok(()) };
        positive("time.collision_step", step)?;
        let steps = self.window / step;
        let whole = steps >= 0.5 && (steps - steps.round()).abs() < 1e-6 * steps;
        require(whole, "measure.window", &self.window, format!("a whole number of time steps of {step}"))
    }
}

/// A run with its measurements.
pub struct Run {
    model: Model,
    engine: Engine,
    sampling: Sampling,
    start: Start,
    impulses: [Vec<Vector>; 4],
    heights: Vec<f64>,
    profile: Profile,
    map: DensityMap,
    mark: Mark,
}

/// Where the engine last started anew, and what had been measured by then.
struct Mark {
    state: State,
    windows: usize,
    profile: Profile,
    map: DensityMap,
}

/// What a run found.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Time measured.
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
    /// Solid fraction across the cell.
    pub map: DensityMap,
    /// Balances of the whole run.
    pub balance: Balance,
    /// Sums over the whole run.
    pub tally: Tally,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Largest overlap, over the diameter, that needs no warning.
const OVERLAP: f64 = 0.02;
/// Largest share of energy or momentum that the balances may lose to round-off.
const UNBALANCED: f64 = 1e-9;

impl Run {
    /// Starts a run.
    pub fn new(
        model: &Model,
        grains: &Grains,
        collisions: Collisions,
        sampling: Sampling,
    ) -> Result<Self, ParameterError> {
        sampling.check(collisions)?;
        let engine = Engine::new(model, grains, collisions)?;
        let start = Start::new(model, &engine);
        // A free top wall may rise.
        let height = model.parameters().height * if model.is_lid_free() { 1.25 } else { 1.0 };
        let (profile, map) =
            (Profile::new(model, height, sampling.layers), DensityMap::new(model, height, sampling.pixels));
        let mark = Mark { state: State::new(model, grains), windows: 0, profile: profile.clone(), map: map.clone() };
        Ok(Self {
            model: *model,
            engine,
            sampling,
            start,
            impulses: Default::default(),
            heights: Vec::new(),
            profile,
            map,
            mark,
        })
    }

    /// Runs for a time without measuring, as long as the grains are not jammed and `go_on` says so. Returns whether it
    /// got there.
    pub fn settle(&mut self, duration: f64, go_on: &dyn Fn() -> bool) -> bool {
        self.engine.advance(duration, go_on)
    }

    /// The same while measuring, for the nearest whole number of windows.
    pub fn measure(&mut self, duration: f64, go_on: &dyn Fn() -> bool) -> bool {
        for _ in 0..(duration / self.sampling.window).round() as u64 {
            let before = *self.engine.tally();
            if !go_on() || !self.engine.advance(self.sampling.window, go_on) {
                return false;
            }
            let after = self.engine.tally();
            for (side, impulses) in self.impulses.iter_mut().enumerate() {
                impulses.push(after.walls[side].impulse - before.walls[side].impulse);
            }
            self.heights.push(self.engine.lid().height);
            if (self.heights.len() as u64).is_multiple_of(self.sampling.every) {
                let grains = self.engine.grains();
                self.profile.add(&self.model, &grains);
                self.map.add(&self.model, &grains);
            }
        }
        true
    }

    /// Starts the engine anew from where it is, as one that resumes does.
    pub fn renew(&mut self) -> Result<(), ParameterError> {
        let state = self.engine.checkpoint(&self.model)?;
        self.mark = self.mark_at(state);
        Ok(())
    }

    /// Goes back to where the engine last started anew.
    pub fn go_back(&mut self) -> Result<(), ParameterError> {
        self.engine = Engine::resume(&self.model, &self.mark.state, self.engine.collisions())?;
        self.heights.truncate(self.mark.windows);
        self.impulses.iter_mut().for_each(|impulses| impulses.truncate(self.mark.windows));
        (self.profile, self.map) = (self.mark.profile.clone(), self.mark.map.clone());
        Ok(())
    }

    fn mark_at(&self, state: State) -> Mark {
        Mark { state, windows: self.heights.len(), profile: self.profile.clone(), map: self.map.clone() }
    }

    /// All that a checkpoint needs besides the grains. A run that was renewed goes on as one that resumes does, to the
    /// last bit.
    pub fn to_numbers(&self) -> Vec<f64> {
        let mut numbers = Numbers::default();
        let (lid, tally) = (self.engine.lid(), *self.engine.tally());
        State { grains: Grains::default(), lid, tally }.keep(&mut numbers);
        self.start.keep(&mut numbers);
        numbers.list(&self.heights);
        for impulses in &self.impulses {
            numbers.vectors(impulses);
        }
        self.profile.keep(&mut numbers);
        self.map.keep(&mut numbers);
        numbers.into_values()
    }

    /// Goes on from the grains and the numbers of a checkpoint; the rest as for a new run.
    pub fn resume(
        model: &Model,
        grains: &Grains,
        (collisions, sampling): (Collisions, Sampling),
        numbers: &[f64],
    ) -> Result<Self, ParameterError> {
        let mut run = Self::new(model, grains, collisions, sampling)?;
        let mut numbers = Numbers::from(numbers);
        let state = State::kept(grains, &mut numbers);
        run.engine = Engine::resume(model, &state, collisions)?;
        run.start = Start::kept(&mut numbers);
        run.heights = numbers.take_list();
        for impulses in &mut run.impulses {
            *impulses = numbers.take_vectors();
        }
        run.profile.recall(&mut numbers);
        run.map.recall(&mut numbers);
        require(numbers.are_spent(), "checkpoint", &"of another form", "the numbers that a run of this scene keeps")?;
        run.mark = run.mark_at(state);
        Ok(run)
    }

    /// The engine, to look at.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// How the cell is now, and averages since an earlier tally.
    pub fn sample_since(&self, before: &Tally) -> Sample {
        Sample::of(&self.model, &self.engine, (before, self.start.balance(&self.model, &self.engine)))
    }

    /// The results so far; stresses and profiles of what was measured.
    pub fn report(&self) -> Report {
        let (model, tally) = (&self.model, *self.engine.tally());
        let window = self.sampling.window;
        let height = estimate(&self.heights);
        let p = model.parameters();
        let volume = self.engine.grains().len() as f64 * PI / 6.0 * p.diameter.powi(3);
        let balance = self.start.balance(model, &self.engine);
        Report {
            measured: self.heights.len() as f64 * window,
            walls: Side::ALL.map(|side| WallStress::new(model, side, &self.impulses[side as usize], window)),
            height,
            solid_fraction: volume / (p.length * p.width * height.mean),
            temperature: self.profile.temperature(),
            layers: self.profile.layers(),
            map: self.map.clone(),
            balance,
            tally,
            warnings: warnings(&tally, &balance),
        }
    }
}

fn warnings(tally: &Tally, balance: &Balance) -> Vec<String> {
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
        format!("the balance of {what} is off by {left:.1e} of what went through it: this is an error of the program")
    });
    overlap.into_iter().chain(unbalanced).collect()
}
