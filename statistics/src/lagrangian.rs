//! Lagrangian statistics: velocity autocorrelations and mean square displacements.

use crate::{State, Store};
use domain::Vector;

mod sums;
pub use sums::LagSums;

/// A particle's velocity and path at one time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrackedMotion {
    /// Velocity relative to the flow.
    pub velocity: Vector,
    /// Integral of that velocity over time: the displacement without that by the background flow.
    pub path: Vector,
}

/// Averages over particles and starting times for one time lag `t`, component by component; `d = path(t) - path(0)`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Lag {
    /// Time lag.
    pub time: f64,
    /// `<v(0) v(t)> - <v(0)> <v(t)>`; over its value at lag 0, the autocorrelation `R(t)`.
    pub correlation: Vector,
    /// `<v(0) v(t)>`, with the means.
    pub product: Vector,
    /// `<d^2> - <d>^2`, the mean square displacement.
    pub mean_square_displacement: Vector,
    /// `<v(0) d> - <v(0)> <d>`, which is the integral of the correlation from 0 to `t`, without an error of quadrature:
    /// the diffusivity of eq. (16) for a long lag.
    pub correlation_integral: Vector,
}

/// Multiple-tau correlator, at lags whose spacing grows with the lag (Magatti & Ferri, Appl. Opt. 40, 4011, 2001;
/// Ramirez et al., J. Chem. Phys. 133, 154103, 2010): level `l` keeps the latest samples whose number is a multiple
/// of `2^l`, and correlates each new one with them. Samples are skipped, not averaged, so every lag is exact. Memory
/// grows as the logarithm of the number of samples.
///
/// The particles of a species are divided into a few groups, and errors are standard errors over the groups. As all
/// groups move in the same flow, they are lower bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct Lagrangian {
    /// Class of each particle: its species and group.
    classes: Vec<usize>,
    class_count: usize,
    samples: u64,
    levels: Vec<LagLevel>,
}

/// Number of samples that a level keeps; the levels above the first use the older half of them.
const KEPT: usize = 16;
/// Number of groups of each species.
const GROUPS: usize = 8;
/// Numbers stored for a particle's motion.
const WIDTH: usize = 6;
/// Number of sums for one lag and class: the count, the lag, and for each component `v0, v1, v0 v1, d, d^2, v0 d`.
const SUMS: usize = 2 + 3 * 6;

/// Samples and sums of one spacing.
#[derive(Debug, Clone, Default, PartialEq)]
struct LagLevel {
    pushed: u64,
    /// Time of each slot; NaN for a missing sample.
    times: Vec<f64>,
    /// `[slot][particle][component]`
    history: Vec<f64>,
    /// `[lag][class][sum]`
    sums: Vec<f64>,
}

/// Classes of the particles: species and groups.
struct Classes<'a> {
    of_particles: &'a [usize],
    count: usize,
}

impl LagLevel {
    fn new(particles: usize, classes: usize) -> Self {
        let history = vec![0.0; KEPT * particles * WIDTH];
        Self { pushed: 0, times: vec![0.0; KEPT], history, sums: vec![0.0; KEPT * classes * SUMS] }
    }

    fn slot(&self, sample: u64) -> (usize, usize) {
        let slot = (sample % KEPT as u64) as usize;
        (slot, slot * self.history.len() / KEPT)
    }

    /// Stores a sample and correlates it with those at the lags from `first` on.
    fn push(&mut self, time: f64, motions: &[TrackedMotion], classes: &Classes, first: usize) {
        let &Classes { of_particles, count } = classes;
        let (slot, start) = self.slot(self.pushed);
        self.times[slot] = time;
        for (kept, motion) in self.history[start..].chunks_exact_mut(WIDTH).zip(motions) {
            kept[..3].copy_from_slice(&motion.velocity.to_array());
            kept[3..].copy_from_slice(&motion.path.to_array());
        }
        let known = KEPT.min(self.pushed as usize + 1);
        for lag in first..known {
            let (slot, start) = self.slot(self.pushed - lag as u64);
            let elapsed = time - self.times[slot];
            if elapsed.is_nan() {
                continue;
            }
            let sums = &mut self.sums[lag * count * SUMS..][..count * SUMS];
            for ((then, motion), &class) in self.history[start..].chunks_exact(WIDTH).zip(motions).zip(of_particles) {
                add(&mut sums[class * SUMS..][..SUMS], elapsed, then, motion);
            }
        }
        self.pushed += 1;
    }

    /// Marks samples as missing: nothing is correlated with them.
    fn skip_missing(&mut self, missing: u64) {
        for _ in 0..missing.min(KEPT as u64) {
            let (slot, _) = self.slot(self.pushed);
            self.times[slot] = f64::NAN;
            self.pushed += 1;
        }
    }
}

fn add(sums: &mut [f64], elapsed: f64, then: &[f64], now: &TrackedMotion) {
    sums[0] += 1.0;
    sums[1] += elapsed;
    for component in 0..3 {
        let (before, after) = (then[component], now.velocity[component]);
        let moved = now.path[component] - then[3 + component];
        let terms = [before, after, before * after, moved, moved * moved, before * moved];
        for (sum, term) in sums[2 + 6 * component..].iter_mut().zip(terms) {
            *sum += term;
        }
    }
}

impl Lagrangian {
    /// Numbers of a particle that a level stores for one sample, and number of samples that it stores.
    pub(crate) const WIDTH: usize = WIDTH;
    pub(crate) const KEPT: usize = KEPT;

    /// For particles of the given species.
    pub fn new(species: &[u32]) -> Self {
        Self::after(vec![0; species.iter().max().map_or(0, |&s| s as usize + 1)], species)
    }

    /// For a part of the particles, with the number of particles of each species in the parts before it. The sums of
    /// parts are added number by number, see [`LagSums`].
    pub fn after(mut seen: Vec<u64>, species: &[u32]) -> Self {
        let class_count = seen.len() * GROUPS;
        let class = |&s: &u32| {
            seen[s as usize] += 1;
            s as usize * GROUPS + (seen[s as usize] - 1) as usize % GROUPS
        };
        Self { classes: species.iter().map(class).collect(), class_count, samples: 0, levels: Vec::new() }
    }

    /// Adds a sample: the motions of all particles, in the same order each time.
    pub fn add(&mut self, time: f64, motions: &[TrackedMotion]) {
        assert_eq!(motions.len(), self.classes.len(), "a motion for each particle");
        self.samples = self.samples.saturating_add(1);
        let classes = Classes { of_particles: &self.classes, count: self.class_count };
        for level in 0..=self.samples.trailing_zeros() as usize {
            if level == self.levels.len() {
                self.levels.push(LagLevel::new(self.classes.len(), self.class_count));
            }
            let first = if level == 0 { 0 } else { KEPT / 2 };
            self.levels[level].push(time, motions, &classes, first);
        }
    }

    /// Skips missing samples, so that the next one has its place in the sequence. Samples have to be at equal
    /// intervals apart from those that are missing.
    pub fn skip_missing(&mut self, missing: u64) {
        let next = self.samples.saturating_add(missing);
        for (level, kept) in self.levels.iter_mut().enumerate() {
            kept.skip_missing((next >> level) - (self.samples >> level));
        }
        self.samples = next;
    }

    /// The sums so far.
    pub fn sums(&self) -> LagSums {
        let numbers = self.levels.iter().flat_map(|level| &level.sums).copied().collect();
        LagSums::of_numbers(self.class_count / GROUPS, numbers)
    }

    /// Number of particles.
    pub fn particles(&self) -> usize {
        self.classes.len()
    }

    /// Whether a restored state is for the same number of particles.
    pub fn fits(&self) -> bool {
        let [history, sums] = [self.classes.len() * WIDTH, self.class_count * SUMS].map(|width| width * KEPT);
        let fits = |level: &LagLevel| {
            level.times.len() == KEPT && level.history.len() == history && level.sums.len() == sums && level.pushed > 0
        };
        self.levels.iter().all(fits)
    }
}

impl State for Lagrangian {
    fn visit(&mut self, store: &mut dyn Store) {
        store.count(&mut self.samples);
        let mut count = self.levels.len() as u64;
        store.count(&mut count);
        let new = || LagLevel::new(self.classes.len(), self.class_count);
        self.levels.resize_with(count.min(64) as usize, new);
        for level in &mut self.levels {
            store.count(&mut level.pushed);
            for numbers in [&mut level.times, &mut level.history, &mut level.sums] {
                store.numbers(numbers);
            }
        }
    }
}

#[cfg(test)]
mod tests;
