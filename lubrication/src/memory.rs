//! Memory of the tables of lubrication.

use domain::Bytes;

use crate::block_factor::LANES;
use crate::factor_table::{FactorTable, NODES, piece_of};
use crate::lubrication_range::LubricationRange;
use crate::pair_force::PairForce;
use crate::sphere_row::SPHERE_ROW;

impl PairForce {
    /// Bytes of the tables for all pairs of the given radii.
    pub fn bytes(radii: &[f64]) -> Bytes {
        let ratios = radii.iter().enumerate().flat_map(|(i, a)| radii[i..].iter().map(move |b| a.max(*b) / a.min(*b)));
        Bytes::keep(ratios.map(FactorTable::bytes).sum())
    }

    /// Bytes of the [`GapSeries`](crate::GapSeries) of the stiff pairs of the given radii, and of the soft ones with
    /// each of their spheres first; pairs are stiff up to about `stiff_gap` over the smaller radius.
    pub fn series_bytes(radii: &[f64], range: LubricationRange, stiff_gap: f64) -> f64 {
        let of_pair = |a: f64, b: f64| {
            let (small, large) = (a.min(b), a.max(b));
            let [closest, farthest] = [range.minimum_gap() * 0.5 * (a + b), range.cutoff() * large];
            let [first, middle, last] = [closest / small, stiff_gap, farthest / small].map(piece_of);
            let stiff = if a <= b { (1 + last - first) * (1 + NODES * LANES) } else { 0 };
            let soft = (1 + last.saturating_sub(middle)) * (1 + NODES * (SPHERE_ROW - 1));
            (size_of::<f64>() * (stiff + soft)) as f64
        };
        radii.iter().flat_map(|&a| radii.iter().map(move |&b| of_pair(a, b))).sum()
    }
}
