//! Resistance coefficients of one sphere of a pair.

use crate::arithmetic::Arithmetic;
use crate::coefficients::Coefficients;

/// Count of the coefficients, and one more for their common factor.
pub const SPHERE_ROW: usize = 24;

/// [`Coefficients`] of one sphere of a pair. Of two values, the first is by its own motion and the second by that of
/// the other sphere.
#[derive(Debug, Clone, Copy)]
pub struct SphereRow<X> {
    /// `X^A`: force by velocity along the axis.
    pub xa: [X; 2],
    /// `Y^A`: force by velocity normal to the axis.
    pub ya: [X; 2],
    /// `X^C`: torque by angular velocity along the axis.
    pub xc: [X; 2],
    /// `Y^C`: torque by angular velocity normal to the axis.
    pub yc: [X; 2],
    /// `Y^B`: force by angular velocity.
    pub yb: [X; 2],
    /// `Y^B`: force on the other sphere by the angular velocity of this one, and by symmetry torque by the velocity
    /// of the other.
    pub yb_other: X,
    /// `X^G`: first moment by velocity along the axis.
    pub xg: [X; 2],
    /// `Y^G`: first moment by velocity normal to the axis.
    pub yg: [X; 2],
    /// `Y^H`: first moment by angular velocity.
    pub yh: [X; 2],
    /// `X^G`: force along the axis by strain.
    pub xg_strain: X,
    /// `Y^G`: force normal to the axis by strain.
    pub yg_strain: X,
    /// `Y^H`: torque by strain.
    pub yh_strain: X,
    /// `(X^M - Z^M)/2`: first moment by strain along the axis, in addition to `zm`.
    pub xm_minus_zm_half: X,
    /// `Y^M - Z^M`: first moment by shear between the axis and its normal plane, in addition to `zm`.
    pub ym_minus_zm: X,
    /// `Z^M`: first moment by any strain.
    pub zm: X,
}

impl<X: Arithmetic> SphereRow<X> {
    /// These coefficients times a factor.
    #[inline(always)]
    #[must_use]
    pub fn times(&self, factor: X) -> Self {
        let n = |number: X| number * factor;
        let two = |[one, other]: [X; 2]| [one * factor, other * factor];
        Self {
            xa: two(self.xa),
            ya: two(self.ya),
            xc: two(self.xc),
            yc: two(self.yc),
            yb: two(self.yb),
            xg: two(self.xg),
            yg: two(self.yg),
            yh: two(self.yh),
            yb_other: n(self.yb_other),
            xg_strain: n(self.xg_strain),
            yg_strain: n(self.yg_strain),
            yh_strain: n(self.yh_strain),
            xm_minus_zm_half: n(self.xm_minus_zm_half),
            ym_minus_zm: n(self.ym_minus_zm),
            zm: n(self.zm),
        }
    }

    /// Coefficients of the larger sphere if `is_larger` is 1, of the smaller one if it is 0.
    #[inline(always)]
    pub fn of(c: &Coefficients<X>, is_larger: X) -> Self {
        let is_smaller = X::constant(1.0) - is_larger;
        let own = |[smaller, larger]: [X; 2]| is_smaller * smaller + is_larger * larger;
        let both = |c: [[X; 2]; 2]| [own([c[0][0], c[1][1]]), own([c[0][1], c[1][0]])];
        // Symmetric entries are the same on both sides, to the bit.
        let symmetric = |c: [[X; 2]; 2]| [own([c[0][0], c[1][1]]), c[0][1]];
        Self {
            xa: symmetric(c.xa),
            ya: symmetric(c.ya),
            xc: symmetric(c.xc),
            yc: symmetric(c.yc),
            yb: both(c.yb),
            yb_other: own([c.yb[1][0], c.yb[0][1]]),
            xg: both(c.xg),
            yg: both(c.yg),
            yh: both(c.yh),
            xg_strain: own(c.xg_strain),
            yg_strain: own(c.yg_strain),
            yh_strain: own(c.yh_strain),
            xm_minus_zm_half: own(c.xm_minus_zm_half),
            ym_minus_zm: own(c.ym_minus_zm),
            zm: own(c.zm),
        }
    }

    /// The coefficients as a list, with a zero at the end.
    pub(crate) fn numbers(&self) -> [X; SPHERE_ROW] {
        let [[a, b], [c, d], [e, f], [g, h], [i, j]] = [self.xa, self.ya, self.xc, self.yc, self.yb];
        let [[k, l], [m, n], [o, p]] = [self.xg, self.yg, self.yh];
        let by_strain = [self.xg_strain, self.yg_strain, self.yh_strain];
        let ([q, r, s], [t, u, v]) = (by_strain, [self.xm_minus_zm_half, self.ym_minus_zm, self.zm]);
        [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, self.yb_other, q, r, s, t, u, v, X::constant(0.0)]
    }

    /// From a list of coefficients with their common factor at the end.
    #[inline(always)]
    pub fn from_numbers(numbers: &[X; SPHERE_ROW]) -> Self {
        let n = |k: usize| numbers[k] * numbers[SPHERE_ROW - 1];
        let two = |k: usize| [n(k), n(k + 1)];
        Self {
            xa: two(0),
            ya: two(2),
            xc: two(4),
            yc: two(6),
            yb: two(8),
            xg: two(10),
            yg: two(12),
            yh: two(14),
            yb_other: n(16),
            xg_strain: n(17),
            yg_strain: n(18),
            yh_strain: n(19),
            xm_minus_zm_half: n(20),
            ym_minus_zm: n(21),
            zm: n(22),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_same_side() {
        let mut numbers: [f64; SPHERE_ROW] = std::array::from_fn(|k| 1.0 + k as f64);
        numbers[SPHERE_ROW - 1] = 1.0;
        let back = SphereRow::from_numbers(&numbers).numbers();
        assert_eq!(back[..SPHERE_ROW - 1], numbers[..SPHERE_ROW - 1]);
        numbers[SPHERE_ROW - 1] = 0.5;
        let half = SphereRow::from_numbers(&numbers);
        assert_eq!((half.xa, half.zm), ([0.5, 1.0], 11.5));
    }
}
