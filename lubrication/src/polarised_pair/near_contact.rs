//! Table of the moments of near pairs that dipoles alone leave out.

use super::{PairMoments, PolarisablePair, dipole_moments, exact_moments};
use crate::chebyshev::{Chebyshev, Powers};
use crate::factor_table::relative;
use std::array::from_fn;

/// Smallest gap of the table over the mean radius; below it moments go on along their tangent.
const NEAREST: f64 = 1e-4;

/// Distance of the centres over the sum of the radii up to which the difference is tabulated. There it is some 1e-5 of
/// the moments.
const REACH: f64 = 2.0;

/// Factor by which consecutive intervals of gaps grow, and points in each.
const GROWTH: f64 = 4.0;
const NODES: usize = 10;

/// Count of the tabulated functions: the moments of both spheres along and across the line of centres, and their
/// slopes.
const FUNCTIONS: usize = 8;

/// Moments of a pair of spheres in a uniform field by the exact solution minus those by dipoles, as functions
/// of the distance. A linear function is subtracted so that values and slopes vanish at the reach.
///
/// In each interval of gaps, with the geometric mean `m` of its ends, they are interpolated in `(h - m) / (h + m)`, as
/// resistances are: it is nearly half the logarithm of `h / m`, and as smooth, but computed without a logarithm.
#[derive(Debug, Clone)]
pub struct PolarisedPairTable {
    /// Sum of the radii; smallest gap, the unit of gaps of the intervals.
    sum: f64,
    nearest: f64,
    reach: f64,
    /// Series of the values, and of the slopes by the logarithm of the gap.
    pieces: Vec<Powers<FUNCTIONS, NODES>>,
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
        let difference = |gap: f64| {
            let distance = sum + gap * nearest;
            let PairMoments { along, across } = exact_moments(pair, distance).minus(&dipole_moments(pair, distance));
            [along[0], along[1], across[0], across[1]]
        };
        let pieces = (0..=piece_of((reach - sum) / nearest)).map(|k| series(mean_of(k), difference)).collect();
        let table = Self { sum, nearest, reach, pieces, at_reach: [[0.0; 4]; 2] };
        Self { at_reach: table.of_gap(reach - sum), ..table }
    }

    /// Distance of the centres up to which there is a difference.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The difference at a distance of the centres; `None` beyond the reach.
    #[inline(always)]
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
    #[inline(always)]
    fn of_gap(&self, gap: f64) -> [[f64; 4]; 2] {
        let inside = gap.max(self.nearest);
        let over_nearest = inside / self.nearest;
        let piece = piece_of(over_nearest).min(self.pieces.len() - 1);
        let mut found = [0.0; FUNCTIONS];
        self.pieces[piece].write::<f64, FUNCTIONS>(relative(over_nearest, mean_of(piece)), &mut found);
        let (values, slopes): ([f64; 4], [f64; 4]) = (from_fn(|k| found[k]), from_fn(|k| found[4 + k] / inside));
        [from_fn(|k| values[k] + slopes[k] * (gap - inside)), slopes]
    }
}

/// Interval of a gap over the smallest one, by the binary exponent.
#[inline(always)]
fn piece_of(gap: f64) -> usize {
    (gap.to_bits() >> 52).saturating_sub(1023) as usize / 2
}

/// Geometric mean of the ends of an interval, over the smallest gap.
#[inline(always)]
fn mean_of(piece: usize) -> f64 {
    2.0 * (1_u64 << (2 * piece)) as f64
}

/// Series of functions of the gap and of their derivatives by its logarithm, `(1 - u^2) / 2` times those by the
/// variable `u` of interpolation, in an interval with a given mean.
fn series(mean: f64, functions: impl Fn(f64) -> [f64; 4]) -> Powers<FUNCTIONS, NODES> {
    let edge = relative(GROWTH.sqrt(), 1.0);
    let nodes = Chebyshev::<4, NODES>::nodes(-edge, edge);
    let values = Chebyshev::through(-edge, edge, &nodes.map(|u| functions(mean * (1.0 + u) / (1.0 - u))));
    let slopes = values.derivative();
    let both = nodes.map(|u| {
        let (values, slopes) = (values.at(u), slopes.at(u));
        from_fn(|k| if k < 4 { values[k] } else { 0.5 * (1.0 - u * u) * slopes[k - 4] })
    });
    Powers::from(&Chebyshev::through(-edge, edge, &both))
}
