//! State of the cell at one time, for the time series.

use super::super::{Engine, Model, Profile, Side, Tally, measure::Balance};
use domain::Vector;
use std::f64::consts::PI;

/// Smallest thickness, in diameters, of the layers relative to which the granular temperature of a sample is taken.
const THICKNESS: f64 = 0.5;
/// Largest number of layers; in a higher cell they are thicker.
const MOST: f64 = 10_000.0;

/// State of the cell at one time, and averages since an earlier time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Normal stress (pressure is positive), shear stress along the flow and shear stress across it on each wall, in
    /// the order of [`Side::ALL`]. NaN without time to average over.
    pub stresses: [[f64; 3]; 4],
    /// Height of the top wall.
    pub height: f64,
    /// Solid fraction under the top wall.
    pub solid_fraction: f64,
    /// Granular temperature relative to the profile across the gap.
    pub temperature: f64,
    /// Collisions between grains and with walls since the earlier time.
    pub hits: [f64; 2],
    /// Largest overlap so far, over the diameter.
    pub largest_overlap: f64,
    /// Balances of the whole run.
    pub balance: Balance,
}

impl Sample {
    /// Names and units of the quantities other than the stresses.
    pub const COLUMNS: [(&str, &str); 8] = [
        ("height", "length"),
        ("solid_fraction", ""),
        ("temperature", "length^2/time^2"),
        ("pair_hits", ""),
        ("wall_hits", ""),
        ("largest_overlap", ""),
        ("energy_imbalance", ""),
        ("momentum_imbalance", ""),
    ];

    /// The values in the order of [`Self::COLUMNS`].
    pub fn values(&self) -> [f64; Self::COLUMNS.len()] {
        let Self { height, solid_fraction, temperature, hits, largest_overlap, balance, .. } = *self;
        [height, solid_fraction, temperature, hits[0], hits[1], largest_overlap, balance.energy, balance.momentum]
    }

    pub(in super::super) fn of(model: &Model, engine: &Engine, (before, balance): (&Tally, Balance)) -> Self {
        let (now, grains, height) = (engine.tally(), engine.grains(), engine.lid().height);
        let time = now.time - before.time;
        let stress = |side: Side| {
            let impulse = now.walls[side as usize].impulse - before.walls[side as usize].impulse;
            let normal = model.face(side, 0.0).normal();
            let across = if side.axis() == 1 { Vector::Z } else { Vector::Y };
            [-normal, Vector::X, across].map(|direction| impulse.dot(direction) / (model.area(side) * time))
        };
        let p = model.parameters();
        let layers = (height / (THICKNESS * p.diameter)).clamp(1.0, MOST) as usize;
        let mut profile = Profile::new(model, height, layers);
        profile.add(model, &grains);
        let wall_hits = |tally: &Tally| tally.walls.iter().map(|w| w.hits).sum::<u64>();
        let hits = [now.pair_hits - before.pair_hits, wall_hits(now) - wall_hits(before)];
        Self {
            stresses: Side::ALL.map(stress),
            height,
            solid_fraction: grains.len() as f64 * PI / 6.0 * p.diameter.powi(3) / (p.length * p.width * height),
            temperature: profile.temperature(),
            hits: hits.map(|n| n as f64),
            largest_overlap: now.largest_overlap,
            balance,
        }
    }
}
