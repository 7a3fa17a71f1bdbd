//! Resistance of contacts, pair by pair.

use crate::pairs::matrix::lanes::{LANES, SimdLanes};
use lubrication::{Arithmetic, Coefficients};
use simd::SimdVector as Width;

/// Resistances of contacts to slip and to rolling, one per lane, and the arms of the smaller and the larger sphere.
#[derive(Default)]
pub struct ContactResistances {
    slip: [f64; LANES],
    rolling: [f64; LANES],
    arms: [[f64; LANES]; 2],
}

impl ContactResistances {
    /// Sets the contact of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, [slip, rolling]: [f64; 2], distance: f64, radii: [f64; 2]) {
        let [smaller, larger] = [radii[0].min(radii[1]), radii[0].max(radii[1])];
        let sum = smaller + larger;
        self.slip[lane] = slip;
        self.arms[0][lane] = distance * smaller / sum;
        self.arms[1][lane] = distance * larger / sum;
        self.rolling[lane] = rolling * (2.0 * smaller * larger / sum).powi(2);
    }

    /// Adds the resistances of contacts. With `s = 1` for the smaller sphere and `-1` for the larger, the arms `b` and
    /// the slip velocity `v`, the rate of work is
    ///
    /// ```text
    /// slip v^2 + rolling |(sum s Omega) x z|^2,        v = (sum s U)_across + (sum b Omega) x z
    /// ```
    #[inline(always)]
    pub fn add_to<V: Width<f64>>(&self, coefficients: &mut Coefficients<SimdLanes<V>>) {
        let (slip, rolling) = (SimdLanes::read(&self.slip), SimdLanes::read(&self.rolling));
        let arms = [SimdLanes::read(&self.arms[0]), SimdLanes::read(&self.arms[1])];
        let signs = [SimdLanes::constant(1.0), SimdLanes::constant(-1.0)];
        for k in 0..2 {
            for l in 0..2 {
                let sign = signs[k] * signs[l];
                coefficients.ya[k][l] = coefficients.ya[k][l].plus(slip, sign);
                coefficients.yb[k][l] = coefficients.yb[k][l].plus(slip, signs[k] * arms[l]);
                coefficients.yc[k][l] = coefficients.yc[k][l].plus(slip, arms[k] * arms[l]).plus(rolling, sign);
            }
        }
    }
}
