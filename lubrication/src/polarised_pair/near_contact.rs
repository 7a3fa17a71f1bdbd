//! Table of the moments of near pairs that dipoles alone leave out.

use super::{PairMoments, PolarisablePair, dipole_moments, exact_moments};
use crate::chebyshev::Chebyshev;
use std::array::from_fn;

/// Smallest gap of the table over the mean radius; below it moments go on along their tangent.
const NEAREST: f64 = 1e-4;

/// Distance of the centres over the sum of the radii up to which the difference is tabulated. There it is some 1e-5 of
/// the moments.
const REACH: f64 = 2.0;

/// Factor by which consecutive intervals of gaps grow, and points in each.
const GROWTH: f64 = 4.0;
const NODES: usize = 8;

/// Moments of a pair of spheres in a uniform field by the exact solution minus those by dipoles, as functions
/// of the distance. A linear function is subtracted so that values and slopes vanish at the reach.
#[derive(Debug, Clone)]
pub struct PolarisedPairTable {
    /// Sum of the radii; smallest gap, and its logarithm.
    sum: f64,
    nearest: f64,
    nearest_log: f64,
    reach: f64,
    /// Series of the values and of the slopes in the logarithm of the gap.
    pieces: Vec<Chebyshev<8, NODES>>,
    /// Values and slopes at the reach.
    at_reach: [[f64; 4]; 2],
}

/// Additional moments of a pair, and their derivatives with respect to the distance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PairPolarisation {
    /// Moments over the field.
    pub moments: PairMoments,
    /// Derivatives.
    pub slopes: PairMoments,
}

impl PolarisedPairTable {
    /// Computes the table of two polarisable spheres; the susceptibilities are not zero.
    pub fn new(pair: &PolarisablePair) -> Self {
        let sum = pair.radii[0] + pair.radii[1];
        let (nearest, reach) = (0.5 * NEAREST * sum, REACH * sum);
        let count = ((reach - sum) / nearest).log(GROWTH).ceil() as usize;
        let difference = |log: f64| {
            let distance = sum + log.exp();
            let PairMoments { along, across } = exact_moments(pair, distance).minus(&dipole_moments(pair, distance));
            [along[0], along[1], across[0], across[1]]
        };
        let piece = |k: usize| {
            let [from, to] = [0, 1].map(|end| (nearest * GROWTH.powi((k + end) as i32)).ln());
            with_slopes(from, to, difference)
        };
        let pieces = (0..count).map(piece).collect();
        let table = Self { sum, nearest, nearest_log: nearest.ln(), reach, pieces, at_reach: [[0.0; 4]; 2] };
        Self { at_reach: table.of_gap(reach - sum), ..table }
    }

    /// Distance of the centres up to which there is a difference.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The difference at a distance of the centres; `None` beyond the reach.
    pub fn at(&self, distance: f64) -> Option<PairPolarisation> {
        let beyond = distance - self.reach;
        if beyond >= 0.0 {
            return None;
        }
        let ([values, slopes], [last, last_slopes]) = (self.of_gap(distance - self.sum), self.at_reach);
        let moments = |v: [f64; 4]| PairMoments { along: [v[0], v[1]], across: [v[2], v[3]] };
        let values = from_fn(|k| values[k] - last[k] - last_slopes[k] * beyond);
        let slopes = from_fn(|k| slopes[k] - last_slopes[k]);
        Some(PairPolarisation { moments: moments(values), slopes: moments(slopes) })
    }

    /// Values and slopes of the series at a gap.
    fn of_gap(&self, gap: f64) -> [[f64; 4]; 2] {
        let inside = gap.max(self.nearest);
        let log = inside.ln();
        let piece = (((log - self.nearest_log) / GROWTH.ln()) as usize).min(self.pieces.len() - 1);
        let found = self.pieces[piece].at(log);
        let (values, slopes): ([f64; 4], [f64; 4]) = (from_fn(|k| found[k]), from_fn(|k| found[4 + k] / inside));
        [from_fn(|k| values[k] + slopes[k] * (gap - inside)), slopes]
    }
}

/// Series of functions on an interval, and of their derivatives.
fn with_slopes(from: f64, to: f64, functions: impl Fn(f64) -> [f64; 4]) -> Chebyshev<8, NODES> {
    let nodes = Chebyshev::<4, NODES>::nodes(from, to);
    let values = Chebyshev::through(from, to, &nodes.map(functions));
    let slopes = values.derivative();
    let both = nodes.map(|x| {
        let (values, slopes) = (values.at(x), slopes.at(x));
        from_fn(|k| if k < 4 { values[k] } else { slopes[k - 4] })
    });
    Chebyshev::through(from, to, &both)
}
