//! Memory of the tables of lubrication.

use domain::Bytes;

use crate::factor_table::FactorTable;
use crate::pair_force::PairForce;

impl PairForce {
    /// Bytes of the tables for all pairs of the given radii.
    pub fn bytes(radii: &[f64]) -> Bytes {
        let ratios = radii.iter().enumerate().flat_map(|(i, a)| radii[i..].iter().map(move |b| a.max(*b) / a.min(*b)));
        Bytes::keep(ratios.map(FactorTable::bytes).sum())
    }
}
