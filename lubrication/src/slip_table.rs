//! Tables of the lubrication loads by slip, one per ratio of radii.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::arithmetic::Arithmetic;
use crate::chebyshev::Powers;
use crate::factor_table::{FARTHEST, NODES, mean_of, of_gaps, piece_of, relative};
use crate::far_field;
use crate::two_sphere::TwoSphereError;
use crate::two_sphere::slip::{SLIP_VALUES, SlipValues, TwoSphereSlip};

/// Loads by slip of the exact solution minus those of the force-coupling method, for radii 1 and `ratio`, viscosity 1.
#[derive(Debug)]
pub struct SlipTable {
    pieces: Vec<SlipPiece>,
}

/// Number of values in a table: a multiple of six of the widest vectors.
const LANES: usize = SLIP_VALUES.next_multiple_of(48);

/// Table between two gaps, with their geometric mean.
#[derive(Debug)]
struct SlipPiece {
    mean: f64,
    powers: Powers<LANES, NODES>,
}

/// Table of one ratio, computed by the first thread that needs it while others wait.
type SharedSlipTable = Arc<OnceLock<Result<Arc<SlipTable>, TwoSphereError>>>;

impl SlipTable {
    /// Table of a ratio of at least 1; computed at the first call, then shared.
    pub fn with_ratio(ratio: f64) -> Result<Arc<Self>, TwoSphereError> {
        static TABLES: OnceLock<Mutex<HashMap<u64, SharedSlipTable>>> = OnceLock::new();
        let tables = TABLES.get_or_init(Mutex::default);
        let entry =
            Arc::clone(tables.lock().unwrap_or_else(PoisonError::into_inner).entry(ratio.to_bits()).or_default());
        let computed = || TwoSphereSlip::with_ratio(ratio).map(|exact| Arc::new(Self::compute(&exact)));
        entry.get_or_init(computed).clone()
    }

    fn compute(exact: &TwoSphereSlip) -> Self {
        let radii = [1.0, exact.ratio()];
        let difference = |gap: f64| {
            let (all, known) = (exact.at(gap), far_field::slip(radii, radii[0] + radii[1] + gap));
            std::array::from_fn(|i| if i < SLIP_VALUES { all[i] - known[i] } else { 0.0 })
        };
        let piece = |k: usize| SlipPiece { mean: mean_of(k), powers: of_gaps(mean_of(k), difference) };
        Self { pieces: (0..=piece_of(FARTHEST * exact.ratio())).map(piece).collect() }
    }

    /// Values at a gap between the closest and the farthest, with numbers of any width.
    #[inline(always)]
    pub fn at<X: Arithmetic>(&self, gap: f64) -> SlipValues {
        let piece = &self.pieces[piece_of(gap).min(self.pieces.len() - 1)];
        let mut lanes = [0.0; LANES];
        piece.powers.write::<X, 6>(relative(gap, piece.mean), &mut lanes);
        *lanes.first_chunk().expect("a lane for each value")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between the nodes, as accurate as the tables of the exact loads.
    #[test]
    fn interpolates_between_the_nodes() {
        let table = SlipTable::with_ratio(1.5).unwrap();
        let exact = TwoSphereSlip::with_ratio(1.5).unwrap();
        for gap in (0..40).map(|k| 1.3e-6 * 1.47_f64.powi(k)) {
            let known = far_field::slip([1.0, 1.5], 2.5 + gap);
            for (k, (found, all)) in table.at::<f64>(gap).iter().zip(exact.at(gap)).enumerate() {
                assert!((found - all + known[k]).abs() < 1e-6, "value {k} at {gap}");
            }
        }
    }

    /// The force-coupling method has the exact loads of spheres that are far apart, but for terms of the order of `4 pi
    /// (a/r)^4`: the flow of the second mode that falls like `r^-4`, which the method has not.
    #[test]
    fn little_is_left_far_apart() {
        let (radii, gap) = ([1.0, 1.5], 40.0);
        let (exact, known) = (TwoSphereSlip::with_ratio(1.5).unwrap().at(gap), far_field::slip(radii, 2.5 + gap));
        let small = 4.0 * std::f64::consts::PI * (1.5_f64 / (2.5 + gap)).powi(4);
        for (k, (all, known)) in exact.iter().zip(known).enumerate() {
            assert!((all - known).abs() < 1e-3 * all.abs() + 2.0 * small, "value {k}: {known}, not {all}");
        }
    }
}
