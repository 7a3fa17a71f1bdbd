//! A run of the shear cell: one of the two engines, and what is measured on the way.

use super::{
    Balance, Collisions, DensityMap, Engine, Estimate, Grains, Layer, Model, Profile, Side, Tally, WallStress,
    measure::{Start, estimate},
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
        positive("window", sampling.window)?;
        require(sampling.every > 0, "every", &sampling.every, "at least 1")?;
        require(sampling.layers > 0, "layers", &sampling.layers, "at least 1")?;
        let pixels = sampling.pixels;
        require(pixels[0] > 0 && pixels[1] > 0, "pixels", &format!("{pixels:?}"), "at least 1 along each edge")?;
        if let Collisions::TimeStepped { step } = collisions {
            let steps = sampling.window / step;
            let whole = steps >= 0.5 && (steps - steps.round()).abs() < 1e-6 * steps;
            require(whole, "window", &sampling.window, format!("a whole number of time steps of {step}"))?;
        }
        let engine = Engine::new(model, grains, collisions)?;
        let start = Start::new(model, &engine);
        // A free top wall may rise.
        let height = model.parameters().height * if model.is_lid_free() { 1.25 } else { 1.0 };
        Ok(Self {
            model: *model,
            engine,
            sampling,
            start,
            impulses: Default::default(),
            heights: Vec::new(),
            profile: Profile::new(model, height, sampling.layers),
            map: DensityMap::new(model, height, pixels),
        })
    }

    /// Runs for a time without measuring.
    pub fn settle(&mut self, duration: f64) {
        self.engine.advance(duration);
    }

    /// Runs and measures for the nearest whole number of windows.
    pub fn measure(&mut self, duration: f64) {
        for _ in 0..(duration / self.sampling.window).round() as u64 {
            let before = *self.engine.tally();
            self.engine.advance(self.sampling.window);
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
    }

    /// The engine, to look at.
    pub fn engine(&self) -> &Engine {
        &self.engine
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
