//! Tables of the loads of a squirmer at rest at a plane wall by its own slip.

use std::sync::{Arc, OnceLock};

use super::gap_table::{GapTable, Tabulated};
use super::slip::{self, SLIP_FUNCTIONS};

/// A sphere of radius 1 with slip that is held at a fixed plane wall in fluid at rest far away: its loads on the fluid
/// over viscosity at any gap, the limit of [`TwoSphereSlip`](super::TwoSphereSlip) for a large second sphere.
#[derive(Debug)]
pub struct SphereWallSlip {
    table: GapTable<SLIP_FUNCTIONS, TERMS>,
}

/// Terms of the near-contact expansion: those of regular functions, and the logarithms with unknown coefficients.
const TERMS: usize = 10;

/// Lowest power of the radius over the distance from the wall in each function, as of the resistance at a wall.
const LEADING: [usize; SLIP_FUNCTIONS] = [0, 2, 2, 0, 0, 4, 2, 2, 3, 0, 0];

impl SphereWallSlip {
    /// Tables, computed at the first call, then shared. Must not be called from a rayon task, since the first call
    /// waits for rayon.
    pub fn get() -> Arc<Self> {
        static TABLE: OnceLock<Arc<SphereWallSlip>> = OnceLock::new();
        Arc::clone(TABLE.get_or_init(|| Arc::new(Self::compute())))
    }

    /// All functions at a positive gap, in the order of [`SlipFunction::ALL`](super::SlipFunction::ALL), with `z` the
    /// unit vector from the centre to the wall.
    pub fn at(&self, gap: f64) -> [f64; SLIP_FUNCTIONS] {
        self.table.at(gap)
    }

    fn compute() -> Self {
        let tabulated = Tabulated { size: 1.0, least: 1.0, unit: 1.0, is_even: false, leading: LEADING };
        Self { table: GapTable::compute(tabulated, [[0.0; 3]; SLIP_FUNCTIONS], slip::wall_loads) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::two_sphere::SlipFunction;
    use std::f64::consts::PI;

    #[test]
    fn tables_agree_with_the_solution() {
        let wall = SphereWallSlip::get();
        for gap in (0..26).map(|k| 5e-5 * 2.0_f64.powi(k)) {
            for (k, (found, exact)) in wall.at(gap).into_iter().zip(slip::wall_loads(gap)).enumerate() {
                assert!((found - exact).abs() < 4e-6 * PI, "gap {gap}, function {k}: {found}, not {exact}");
            }
        }
    }

    /// The wall is a sphere of a large radius: corrections are of the order of its inverse, and extrapolation removes
    /// most of them.
    #[test]
    fn the_wall_is_a_large_sphere() {
        for gap in [0.05, 1.0] {
            let at = |ratio: f64| slip::values_of(&slip::loads(ratio, gap), 0, 0);
            for ((large, larger), wall) in at(50.0).into_iter().zip(at(100.0)).zip(slip::wall_loads(gap)) {
                let (off, extrapolated) = ((larger - wall).abs(), 2.0 * larger - large);
                assert!((extrapolated - wall).abs() < 0.1 * off + 1e-6, "gap {gap}: {large}, {larger}, {wall}");
            }
        }
    }

    /// Far from the wall, the image of the force `-4 pi b` increases the load by `9/8` along `z` and `9/16` across,
    /// over the distance. The image of the stresslet moves a puller that swims along the wall away from it by `3/16
    /// B2/z^2` (Berke, Turner, Berg & Lauga, Phys. Rev. Lett. 101, 038102, 2008), and one along the normal by twice
    /// that towards it.
    #[test]
    fn far_away_the_images_of_force_and_stresslet_act() {
        let (distance, found) = (1000.0, slip::wall_loads(999.0));
        for (function, image) in [(SlipFunction::XF1, 9.0 / 8.0), (SlipFunction::YF1, 9.0 / 16.0)] {
            let exact = -4.0 * PI * (1.0 + image / distance);
            let found = found[function as usize];
            assert!((found / exact - 1.0).abs() < 3e-6, "{function:?}: {found}");
        }
        let away = 0.5 * found[SlipFunction::XF2 as usize] / (6.0 * PI);
        assert!((away * distance * distance / (-3.0 / 16.0) - 1.0).abs() < 3e-3, "{away}");
    }
}
