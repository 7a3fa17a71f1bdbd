//! Resistance of bonds to bending and twisting, pair by pair.

use crate::pairs::matrix::lanes::{LANES, SimdLanes};
use lubrication::{Arithmetic, Coefficients};
use simd::SimdVector as Width;

/// Resistances of beams to bending and to twisting, one per lane, and their inverse lengths.
#[derive(Default)]
pub struct BeamResistances {
    bending: [f64; LANES],
    twisting: [f64; LANES],
    per_length: [f64; LANES],
}

impl BeamResistances {
    /// Sets the beam of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, [bending, twisting]: [f64; 2], distance: f64) {
        self.bending[lane] = bending;
        self.twisting[lane] = twisting;
        self.per_length[lane] = 1.0 / distance;
    }

    /// Adds the resistances of beams. With `s = 1` for the smaller sphere and `-1` for the larger, and the distance
    /// `r`, the angular velocities of the ends relative to the line of centres are `w` turned by a right angle about
    /// the axis `z`, and the rate of work is that of the stiffness of an Euler-Bernoulli beam,
    ///
    /// ```text
    /// bending (w1 w1 + w1 w2 + w2 w2) + twisting (sum s z.Omega)^2,        w = (sum s U)_across / r + Omega x z
    /// ```
    #[inline(always)]
    pub fn add_to<V: Width<f64>>(&self, coefficients: &mut Coefficients<SimdLanes<V>>) {
        let constant = SimdLanes::<V>::constant;
        let (bending, twisting) = (SimdLanes::read(&self.bending), SimdLanes::read(&self.twisting));
        let per_length = SimdLanes::read(&self.per_length);
        let lever = constant(1.5) * bending * per_length;
        let across = constant(2.0) * lever * per_length;
        let signs = [constant(1.0), constant(-1.0)];
        for k in 0..2 {
            for l in 0..2 {
                let (sign, share) = (signs[k] * signs[l], constant(if k == l { 1.0 } else { 0.5 }));
                coefficients.ya[k][l] = coefficients.ya[k][l].plus(across, sign);
                coefficients.yb[k][l] = coefficients.yb[k][l].plus(lever, signs[k]);
                coefficients.yc[k][l] = coefficients.yc[k][l].plus(bending, share);
                coefficients.xc[k][l] = coefficients.xc[k][l].plus(twisting, sign);
            }
        }
    }
}
