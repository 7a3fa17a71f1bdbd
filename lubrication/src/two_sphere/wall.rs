//! Tables of the resistance functions of a sphere at a plane wall.

use std::sync::{Arc, OnceLock};

use super::exact;
use super::functions::{Function, WallFunctions};
use super::gap_table::{GapTable, Tabulated};
use super::singular;
use super::table::TwoSphereError;

/// A sphere that moves at a fixed plane wall in fluid at rest far away: its exact resistance functions at any gap, to
/// a relative 1e-8. They are the limit of those of [`TwoSphere`](super::TwoSphere) for a large second sphere.
///
/// Brenner (1961), Jeffery (1915), O'Neill (1964), Goldman, Cox & Brenner (1967) have series and tables of XA, XC,
/// YA, YB and YC.
#[derive(Debug)]
pub struct SphereWall {
    table: GapTable<11>,
}

/// Lowest power of the radius over the distance from the wall in each function, without the constant of an isolated
/// sphere.
const LEADING: [usize; Function::ALL.len()] = [0, 0, 4, 0, 0, 2, 2, 3, 0, 0, 0];

impl SphereWall {
    /// Tables, computed at the first call, then shared. Must not be called from a rayon task, since the first call
    /// waits for rayon.
    pub fn get() -> Arc<Self> {
        static TABLE: OnceLock<Arc<SphereWall>> = OnceLock::new();
        Arc::clone(TABLE.get_or_init(|| Arc::new(Self::compute())))
    }

    /// All functions at `gap`, in units of the sphere's radius; an infinite gap is allowed.
    pub fn resistance(&self, gap: f64) -> Result<WallFunctions, TwoSphereError> {
        if gap > 0.0 { Ok(self.at(gap)) } else { Err(TwoSphereError::Gap(gap)) }
    }

    /// All functions at a positive gap.
    pub(crate) fn at(&self, gap: f64) -> WallFunctions {
        WallFunctions(self.table.at(gap))
    }

    fn compute() -> Self {
        let tabulated = Tabulated { size: 1.0, least: 1.0, unit: 1.0, is_even: false, leading: LEADING };
        let singularities = Function::ALL.map(singular::at_wall);
        Self { table: GapTable::compute(tabulated, singularities, |gap| exact::wall_resistance(gap).0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_agree_with_the_solution() {
        let wall = SphereWall::get();
        let far_from = wall.table.far_from();
        let gaps = (0..30).map(|k| 1e-5 * 1.65_f64.powi(k)).chain([far_from.next_down(), far_from, 100.0]);
        for gap in gaps {
            let (found, exact) = (wall.at(gap), exact::wall_resistance(gap));
            for function in Function::ALL {
                let (found, exact) = (found[function], exact[function]);
                // YH changes sign near contact: an absolute error there, like the terms from which it is subtracted.
                assert!((found - exact).abs() < 1e-8 * exact.abs().max(1e-3), "{function:?} {gap}: {found} {exact}");
            }
        }
    }
}
