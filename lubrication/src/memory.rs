//! What tables of lubrication take.

use domain::Bytes;

use crate::pair_force::PairForce;
use crate::root_table::RootTable;

impl PairForce {
    /// The tables of every two of some radii.
    pub fn bytes(radii: &[f64]) -> Bytes {
        let ratios = radii.iter().enumerate().flat_map(|(i, a)| radii[i..].iter().map(move |b| a.max(*b) / a.min(*b)));
        Bytes::keep(ratios.map(RootTable::bytes).sum())
    }
}
