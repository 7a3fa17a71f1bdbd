//! Resistance coefficients of one sphere of a pair.

use crate::arithmetic::Arithmetic;
use crate::coefficients::Coefficients;

/// Count of the coefficients, and one more for their common factor.
pub const SIDE: usize = 24;

/// [`Coefficients`] of one sphere of a pair. Of two values, the first is by its own motion and the second by that of
/// the other sphere.
#[derive(Debug, Clone, Copy)]
pub struct Side<X> {
    /// `X^A`: force by velocity along the axis.
    pub along: [X; 2],
    /// `Y^A`: force by velocity normal to the axis.
    pub across: [X; 2],
    /// `X^C`: torque by angular velocity along the axis.
    pub spin: [X; 2],
    /// `Y^C`: torque by angular velocity normal to the axis.
    pub roll: [X; 2],
    /// `Y^B`: force by angular velocity.
    pub coupling: [X; 2],
    /// `Y^B`: force on the other sphere by the angular velocity of this one, and by symmetry torque by the velocity
    /// of the other.
    pub leverage: X,
    /// `X^G`: first moment by velocity along the axis.
    pub pull: [X; 2],
    /// `Y^G`: first moment by velocity normal to the axis.
    pub drag: [X; 2],
    /// `Y^H`: first moment by angular velocity.
    pub turn: [X; 2],
    /// `X^G`: force along the axis by strain.
    pub push: X,
    /// `Y^G`: force normal to the axis by strain.
    pub slide: X,
    /// `Y^H`: torque by strain.
    pub twist: X,
    /// `(X^M - Z^M)/2`: first moment by strain along the axis, in addition to `bulk`.
    pub stretch: X,
    /// `Y^M - Z^M`: first moment by shear between the axis and its normal plane, in addition to `bulk`.
    pub bend: X,
    /// `Z^M`: first moment by any strain.
    pub bulk: X,
}

impl<X: Arithmetic> Side<X> {
    /// Coefficients of the larger sphere if `is_larger` is 1, of the smaller one if it is 0.
    #[inline(always)]
    pub fn of(c: &Coefficients<X>, is_larger: X) -> Self {
        let is_smaller = X::constant(1.0) - is_larger;
        let own = |[smaller, larger]: [X; 2]| is_smaller * smaller + is_larger * larger;
        let both = |c: [[X; 2]; 2]| [own([c[0][0], c[1][1]]), own([c[0][1], c[1][0]])];
        // Symmetric entries are the same on both sides, to the bit.
        let symmetric = |c: [[X; 2]; 2]| [own([c[0][0], c[1][1]]), c[0][1]];
        Self {
            along: symmetric(c.along),
            across: symmetric(c.across),
            spin: symmetric(c.spin),
            roll: symmetric(c.roll),
            coupling: both(c.coupling),
            leverage: own([c.coupling[1][0], c.coupling[0][1]]),
            pull: both(c.pull),
            drag: both(c.drag),
            turn: both(c.turn),
            push: own(c.push),
            slide: own(c.slide),
            twist: own(c.twist),
            stretch: own(c.stretch),
            bend: own(c.bend),
            bulk: own(c.bulk),
        }
    }

    /// The coefficients as a list, with a zero at the end.
    pub(crate) fn numbers(&self) -> [X; SIDE] {
        let [[a, b], [c, d], [e, f], [g, h], [i, j]] = [self.along, self.across, self.spin, self.roll, self.coupling];
        let [[k, l], [m, n], [o, p]] = [self.pull, self.drag, self.turn];
        let [push, slide, twist, stretch, bend, bulk] =
            [self.push, self.slide, self.twist, self.stretch, self.bend, self.bulk];
        let zero = X::constant(0.0);
        [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, self.leverage, push, slide, twist, stretch, bend, bulk, zero]
    }

    /// From a list of coefficients with their common factor at the end.
    #[inline(always)]
    pub fn from_numbers(numbers: &[X; SIDE]) -> Self {
        let n = |k: usize| numbers[k] * numbers[SIDE - 1];
        let two = |k: usize| [n(k), n(k + 1)];
        Self {
            along: two(0),
            across: two(2),
            spin: two(4),
            roll: two(6),
            coupling: two(8),
            pull: two(10),
            drag: two(12),
            turn: two(14),
            leverage: n(16),
            push: n(17),
            slide: n(18),
            twist: n(19),
            stretch: n(20),
            bend: n(21),
            bulk: n(22),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_same_side() {
        let mut numbers: [f64; SIDE] = std::array::from_fn(|k| 1.0 + k as f64);
        numbers[SIDE - 1] = 1.0;
        let back = Side::from_numbers(&numbers).numbers();
        assert_eq!(back[..SIDE - 1], numbers[..SIDE - 1]);
        numbers[SIDE - 1] = 0.5;
        let half = Side::from_numbers(&numbers);
        assert_eq!((half.along, half.bulk), ([0.5, 1.0], 11.5));
    }
}
