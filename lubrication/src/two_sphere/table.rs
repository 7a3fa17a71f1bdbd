//! Tables of the resistance functions of one pair of radii.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use domain::Number;
use thiserror::Error;

use super::exact;
use super::functions::{Function, MobilityFunctions, ResistanceFunctions};
use super::gap_table::{GapTable, Tabulated};
use super::mobility::mobility;
use super::singular::{self, Singularity};

/// Largest ratio of the radii.
pub const LARGEST_RATIO: f64 = 20.0;

/// Two spheres whose radii have a given ratio: their exact resistance functions at any gap.
///
/// From contact to 2e-3 of the smaller radius it evaluates the near-contact expansion, then Chebyshev series in the
/// logarithm of the gap, and beyond a gap of the sum of the radii Chebyshev series in `((a1 + a2)/r)²`. All come from
/// the solution in bispherical coordinates.
#[derive(Debug, Clone)]
pub struct TwoSphere {
    ratio: f64,
    table: GapTable<44>,
}

/// Table of one ratio, computed by the first thread that needs it while others wait.
type SharedTwoSphere = Arc<OnceLock<Arc<TwoSphere>>>;

/// Invalid argument of the two-sphere functions.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TwoSphereError {
    /// The ratio of the radii is outside the range of the tables.
    #[error("ratio a2/a1 is {}; the two-sphere functions are tabulated for ratios from 0.05 to 20", Number(*.0))]
    Ratio(f64),
    /// The gap is zero, negative or NaN.
    #[error("gap is {}; the two-sphere functions need spheres that do not touch: give a gap above 0", Number(*.0))]
    Gap(f64),
}

impl TwoSphere {
    /// Tables for radii 1 and `ratio`; computed at the first call for a ratio, then shared. Must not be called from a
    /// rayon task, since the first call waits for rayon.
    pub fn with_ratio(ratio: f64) -> Result<Arc<Self>, TwoSphereError> {
        static TABLES: OnceLock<Mutex<HashMap<u64, SharedTwoSphere>>> = OnceLock::new();
        if !(1.0 / LARGEST_RATIO..=LARGEST_RATIO).contains(&ratio) {
            return Err(TwoSphereError::Ratio(ratio));
        }
        let tables = TABLES.get_or_init(Mutex::default);
        let entry =
            Arc::clone(tables.lock().unwrap_or_else(PoisonError::into_inner).entry(ratio.to_bits()).or_default());
        Ok(Arc::clone(entry.get_or_init(|| Arc::new(Self::compute(ratio)))))
    }

    /// Radius of sphere 2 over that of sphere 1.
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// All functions at `gap`, in units of the radius of sphere 1; an infinite gap is allowed.
    pub fn resistance(&self, gap: f64) -> Result<ResistanceFunctions, TwoSphereError> {
        if gap > 0.0 { Ok(self.at(gap)) } else { Err(TwoSphereError::Gap(gap)) }
    }

    /// All mobility functions at `gap`, in units of the radius of sphere 1; an infinite gap is allowed.
    pub fn mobility(&self, gap: f64) -> Result<MobilityFunctions, TwoSphereError> {
        Ok(mobility(&self.resistance(gap)?, self.ratio))
    }

    /// All functions at a positive gap.
    pub(crate) fn at(&self, gap: f64) -> ResistanceFunctions {
        let flat = self.table.at(gap);
        ResistanceFunctions(std::array::from_fn(|f| [0, 1].map(|i| [0, 1].map(|j| flat[4 * f + 2 * i + j]))))
    }

    fn compute(ratio: f64) -> Self {
        let leading = std::array::from_fn(|i| LEADING[i / 4][usize::from(i % 4 == 1 || i % 4 == 2)]);
        let size = 1.0 + ratio;
        let tabulated = Tabulated { size, least: ratio.min(1.0), unit: 0.5 * size, is_even: true, leading };
        let exact = |gap: f64| flatten(&exact::resistance(ratio, gap));
        Self { ratio, table: GapTable::compute(tabulated, singularities(ratio), exact) }
    }
}

/// Lowest power of `t = (a1 + a2)/r` in a function: for the sphere's own motion, and for that of the other.
const LEADING: [[usize; 2]; Function::ALL.len()] =
    [[0, 1], [0, 1], [3, 2], [0, 3], [0, 3], [3, 2], [5, 4], [6, 3], [0, 3], [0, 3], [0, 5]];

/// Singularities of the functions in table order, for both spheres.
fn singularities(ratio: f64) -> [Singularity; 44] {
    std::array::from_fn(|i| {
        let function = Function::ALL[i / 4];
        let (bears, moves) = (i / 2 % 2, i % 2);
        let (lambda, flip) =
            if bears == 0 { (ratio, 1.0) } else { (1.0 / ratio, if function.is_odd() { -1.0 } else { 1.0 }) };
        let singularity =
            if bears == moves { singular::own(function, lambda) } else { singular::other(function, lambda) };
        singularity.map(|g| g * flip)
    })
}

fn flatten(functions: &ResistanceFunctions) -> [f64; 44] {
    std::array::from_fn(|i| functions.0[i / 4][i / 2 % 2][i % 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest relative error of the tables against the solution itself.
    fn worst(ratio: f64, gaps: impl Iterator<Item = f64>) -> f64 {
        let table = TwoSphere::with_ratio(ratio).unwrap();
        let error = |gap: f64| {
            let (found, wanted) = (flatten(&table.at(gap)), flatten(&exact::resistance(ratio, gap)));
            found.iter().zip(&wanted).map(|(f, w)| (f / w - 1.0).abs()).fold(0.0, f64::max)
        };
        gaps.map(error).fold(0.0, f64::max)
    }

    #[test]
    fn tables_agree_with_the_solution() {
        for ratio in [1.0, 2.0, 2.5, 10.0] {
            let error = worst(ratio, (0..40).map(|k| 5e-4 * 1.47_f64.powi(k)));
            assert!(error < 1e-8, "ratio {ratio}: {error}");
        }
    }

    /// At the end of the last piece, round-off of the logarithm may count one piece too many.
    #[test]
    fn tables_have_no_gap_where_the_far_one_begins() {
        for ratio in [0.5, 1.25, 2.0] {
            let far_from = TwoSphere::with_ratio(ratio).unwrap().table.far_from();
            let error = worst(ratio, [far_from.next_down(), far_from].into_iter());
            assert!(error < 1e-8, "ratio {ratio}: {error}");
        }
    }

    #[test]
    fn near_contact_expansion_agrees_with_the_solution() {
        let error = worst(1.0, [1e-5, 1e-4].into_iter()).max(worst(2.0, [2e-5].into_iter()));
        assert!(error < 1e-8, "{error}");
    }
}
