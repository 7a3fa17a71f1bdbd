//! The Stokes operator mode by mode.

use super::Stokes;
use crate::Real;
use crate::modes::MODES;

/// Consecutive modes along x.
pub(crate) struct ModeBlock {
    /// Components of their wavevectors.
    pub vectors: [[f64; MODES]; 3],
    /// Factors of transverse modes.
    pub factors: [f64; MODES],
}

impl<T: Real> Stokes<T> {
    /// The modes from `[m1, m2, m3]` on; those from `m1 = nx/2` on are zero.
    #[inline(always)]
    pub(crate) fn mode_block(&self, [m1, m2, m3]: [usize; 3]) -> ModeBlock {
        let in_plane = m2 * self.k1.len() + m1;
        let wide = |values: &[T]| -> [f64; MODES] {
            std::array::from_fn(|lane| values.get(lane).map_or(0.0, |value| value.to_f64()))
        };
        let k1 = wide(&self.k1[m1..]);
        let k2 = wide(&self.k2[in_plane..in_plane + self.k1.len() - m1]);
        let plane = wide(&self.plane[in_plane..in_plane + self.k1.len() - m1]);
        let (mut k3, mut axis) = ([self.k3[m3].to_f64(); MODES], [self.axis[m3].to_f64(); MODES]);
        let mut squares = [0.0; MODES];
        if let Some(tilted) = &self.tilted {
            for lane in 0..MODES.min(self.k1.len() - m1) {
                k3[lane] += tilted.shift(in_plane + lane);
                let square = k1[lane] * k1[lane] + k2[lane] * k2[lane] + k3[lane] * k3[lane];
                axis[lane] = if square > 0.0 { tilted.multiplier(in_plane + lane, m3, square) } else { 0.0 };
            }
        }
        let (widening, is_kept) = (self.widening.to_f64(), m3 != self.points[2] / 2);
        let mut factors = [0.0; MODES];
        for lane in 0..MODES {
            squares[lane] = k1[lane] * k1[lane] + k2[lane] * k2[lane] + k3[lane] * k3[lane];
            let level = widening * squares[lane] + 1.0;
            let factor = plane[lane] * axis[lane] * level * level / squares[lane];
            factors[lane] = if is_kept && squares[lane] > 0.0 { factor } else { 0.0 };
        }
        ModeBlock { vectors: [k1, k2, k3], factors }
    }
}
