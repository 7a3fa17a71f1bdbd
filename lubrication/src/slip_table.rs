//! Tables of the lubrication loads by slip, one per ratio of radii.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::arithmetic::Arithmetic;
use crate::chebyshev::Powers;
use crate::factor_table::{FARTHEST, mean_of, of_gaps, piece_of, relative};
use crate::far_field;
use crate::slip_row::{SLIP_ROW, SlipRow};
use crate::two_sphere::TwoSphereError;
use crate::two_sphere::slip::{SlipValues, TwoSphereSlip};

/// Loads of one sphere of a pair by slip, of the exact solution minus those of the force-coupling method, for a smaller
/// radius of 1 and viscosity 1.
#[derive(Debug)]
pub struct SlipTable {
    pieces: Vec<SlipPiece>,
}

/// Interpolation points per interval: the error of a function that is singular at contact falls by a factor of 23 with
/// each, to 1e-8 of its value.
const NODES: usize = 6;

/// Table between two gaps, with their geometric mean.
#[derive(Debug)]
struct SlipPiece {
    mean: f64,
    powers: Powers<SLIP_ROW, NODES>,
}

/// Tables of the smaller and of the larger sphere.
type SlipTables = [Arc<SlipTable>; 2];

/// Tables of one ratio, computed by the first thread that needs them while others wait.
type SharedSlipTables = Arc<OnceLock<Result<SlipTables, TwoSphereError>>>;

impl SlipTable {
    /// Tables of both spheres for a ratio of at least 1; computed at the first call, then shared.
    pub fn with_ratio(ratio: f64) -> Result<SlipTables, TwoSphereError> {
        static TABLES: OnceLock<Mutex<HashMap<u64, SharedSlipTables>>> = OnceLock::new();
        let tables = TABLES.get_or_init(Mutex::default);
        let entry =
            Arc::clone(tables.lock().unwrap_or_else(PoisonError::into_inner).entry(ratio.to_bits()).or_default());
        let computed = || TwoSphereSlip::with_ratio(ratio).map(|exact| Self::compute(&exact));
        entry.get_or_init(computed).clone()
    }

    fn compute(exact: &TwoSphereSlip) -> SlipTables {
        let of_sphere = |own: usize| {
            let piece = |k: usize| {
                let coefficients = |gap: f64| SlipRow::of(&difference(exact, gap), own).numbers();
                SlipPiece { mean: mean_of(k), powers: of_gaps(mean_of(k), coefficients) }
            };
            Arc::new(Self { pieces: (0..=piece_of(FARTHEST * exact.ratio())).map(piece).collect() })
        };
        let small = of_sphere(0);
        // Equal spheres are mirror images.
        let large = if exact.ratio() <= 1.0 { Arc::clone(&small) } else { of_sphere(1) };
        [small, large]
    }

    /// Writes the coefficients at a gap between the closest and the farthest, with numbers of any width.
    #[inline(always)]
    pub fn write<X: Arithmetic>(&self, gap: f64, row: &mut [f64; SLIP_ROW]) {
        let piece = &self.pieces[piece_of(gap).min(self.pieces.len() - 1)];
        piece.powers.write::<X, 3>(relative(gap, piece.mean), row);
    }
}

/// Values of the functions minus those of the force-coupling method.
fn difference(exact: &TwoSphereSlip, gap: f64) -> SlipValues {
    let (radii, all) = ([1.0, exact.ratio()], exact.at(gap));
    let known = far_field::slip(radii, radii[0] + radii[1] + gap);
    std::array::from_fn(|i| all[i] - known[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between the nodes, as accurate as the tables of the exact loads.
    #[test]
    fn interpolates_between_the_nodes() {
        for ratio in [1.0, 1.5] {
            let (tables, exact) = (SlipTable::with_ratio(ratio).unwrap(), TwoSphereSlip::with_ratio(ratio).unwrap());
            for (gap, own) in (0..40).map(|k| 1.3e-6 * 1.47_f64.powi(k)).flat_map(|gap| [(gap, 0), (gap, 1)]) {
                let mut found = [0.0; SLIP_ROW];
                tables[own].write::<f64>(gap, &mut found);
                let expected = SlipRow::of(&difference(&exact, gap), own).numbers();
                for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
                    assert!((found - expected).abs() < 1e-6, "value {k} of sphere {own} at {gap}");
                }
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
