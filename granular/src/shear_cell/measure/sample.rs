//! State of the cell at one time, for the time series.

use super::super::{CellModel, CellTally, Engine, LayerProfile, Side, measure::Balance};
use domain::Vector;

/// Smallest thickness, in diameters, of the layers relative to which the granular temperature of a sample is taken.
const THICKNESS: f64 = 0.5;
/// Largest number of layers; in a higher cell they are thicker.
const MOST: f64 = 10_000.0;

/// State of the cell at one time, and averages since an earlier time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellSample {
    /// Normal stress (pressure is positive), shear stress along the flow and shear stress across it on each wall, in
    /// the order of [`Side::ALL`]. NaN without time to average over.
    pub stresses: [[f64; 3]; 4],
    /// Other quantities, in the order of [`Self::COLUMNS`].
    pub values: [f64; Self::COLUMNS.len()],
}

impl CellSample {
    /// Names and units of the quantities other than the stresses. Collisions are counted since the earlier time,
    /// overlaps and balances since the start.
    pub const COLUMNS: [(&str, &str); 8] = [
        // Of the top wall.
        ("height", "length"),
        // Under the top wall.
        ("solid_fraction", ""),
        // Relative to the profile across the gap.
        ("temperature", "length^2/time^2"),
        ("pair_hits", ""),
        ("wall_hits", ""),
        // Over the diameter.
        ("largest_overlap", ""),
        ("energy_imbalance", ""),
        ("momentum_imbalance", ""),
    ];

    pub(in super::super) fn of(model: &CellModel, engine: &Engine, before: &CellTally, balance: Balance) -> Self {
        let (now, grains, height) = (engine.tally(), engine.grains(), engine.top_wall().height);
        let time = now.time - before.time;
        let stress = |side: Side| {
            let impulse = now.walls[side as usize].impulse - before.walls[side as usize].impulse;
            [-side.normal(), Vector::X, side.across()]
                .map(|direction| impulse.dot(direction) / (model.area(side) * time))
        };
        let layers = (height / (THICKNESS * model.parameters().diameter)).clamp(1.0, MOST) as usize;
        let mut profile = LayerProfile::new(model, height, layers);
        profile.add(model, &grains);
        let solid_fraction = model.solid_fraction(grains.len(), height);
        let wall_collisions = |tally: &CellTally| tally.walls.iter().map(|w| w.collisions).sum::<u64>();
        let pair_hits = (now.pair_collisions - before.pair_collisions) as f64;
        let wall_hits = (wall_collisions(now) - wall_collisions(before)) as f64;
        let (temperature, overlap, Balance { energy, momentum }) =
            (profile.temperature(), now.largest_overlap, balance);
        Self {
            stresses: Side::ALL.map(stress),
            values: [height, solid_fraction, temperature, pair_hits, wall_hits, overlap, energy, momentum],
        }
    }
}
