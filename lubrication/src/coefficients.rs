//! Lubrication resistance of a pair as coefficients of tensors of its axis.

use std::f64::consts::PI;

use crate::arithmetic::Arithmetic;
use crate::pair_factor::LEVER;
use crate::root::LANES;

/// Numbers of a pair from which its coefficients are computed: the lanes of its table, and its sizes.
pub const RECORD: usize = LANES + 6;

/// Positions in a record, after the lanes of the table: the factor of the resistance over that for radii 1 and
/// `ratio`, the smaller radius, the ratio, the square roots of the ratio and of the ratio plus 1, and the inverse of
/// the ratio plus 1.
const FACTOR: usize = LANES;
const RADIUS: usize = LANES + 1;
const RATIO: usize = LANES + 2;
const ROOT: usize = LANES + 3;
const ROOT_OF_SUM: usize = LANES + 4;
const SHARE: usize = LANES + 5;

/// Sizes of a record for radii 1 and `ratio`: the last four, without the factor and the radius.
pub fn sizes(ratio: f64) -> [f64; 4] {
    [ratio, ratio.sqrt(), (1.0 + ratio).sqrt(), 1.0 / (1.0 + ratio)]
}

/// Values by sphere, the smaller one first.
type Each<X> = [X; 2];

/// Values by the sphere with the load and the sphere that moves, the smaller one first.
type Both<X> = [[X; 2]; 2];

/// Resistance of a pair with the unit vector `z` from the smaller sphere to the larger. The loads of one sphere on
/// the fluid by the motion of one, relative to the ambient flow, are
///
/// ```text
/// F = along (z.U) z + across (U - (z.U) z) + coupling Omega x z
/// L = spin (z.Omega) z + roll (Omega - (z.Omega) z) + coupling' z x U
/// M = pull (z.U) (3 zz - 1) + z s + s z,        s = drag (U - (z.U) z) + turn Omega x z
/// ```
///
/// with `coupling'` the coefficient for the two spheres exchanged. A rate of strain `E` of both relative to the
/// ambient flow, with `t = E z - (z.E z) z`, adds
///
/// ```text
/// F = push (z.E z) z + slide t,        L = twist z x t
/// M = E' + stretch (z.E z) (3 zz - 1) + bend (z t + t z),        E' = bulk E
/// ```
///
/// In the notation of Jeffrey & Onishi (1984) and Jeffrey (1992), up to constant factors and powers of the radii, the
/// coefficients are
///
/// ```text
/// along X^A,   across Y^A,   coupling Y^B,   spin X^C,   roll Y^C,   pull X^G,   drag Y^G,   turn Y^H
/// ```
///
/// and, with a sum over the sphere that strains, `push X^G`, `slide Y^G`, `twist Y^H`, `bulk Z^M`, `bend Y^M - Z^M`
/// and `stretch (X^M - Z^M)/2`.
#[derive(Debug, Clone, Copy)]
pub struct Coefficients<X> {
    /// `X^A`: force by velocity along the axis.
    pub along: Both<X>,
    /// `Y^A`: force by velocity normal to the axis.
    pub across: Both<X>,
    /// `X^C`: torque by angular velocity along the axis.
    pub spin: Both<X>,
    /// `Y^C`: torque by angular velocity normal to the axis.
    pub roll: Both<X>,
    /// `Y^B`: force by angular velocity.
    pub coupling: Both<X>,
    /// `X^G`: first moment by velocity along the axis.
    pub pull: Both<X>,
    /// `Y^G`: first moment by velocity normal to the axis.
    pub drag: Both<X>,
    /// `Y^H`: first moment by angular velocity.
    pub turn: Both<X>,
    /// `X^G`: force along the axis by strain.
    pub push: Each<X>,
    /// `Y^G`: force normal to the axis by strain.
    pub slide: Each<X>,
    /// `Y^H`: torque by strain.
    pub twist: Each<X>,
    /// `(X^M - Z^M)/2`: first moment by strain along the axis, in addition to `bulk`.
    pub stretch: Each<X>,
    /// `Y^M - Z^M`: first moment by shear between the axis and its normal plane, in addition to `bulk`.
    pub bend: Each<X>,
    /// `Z^M`: first moment by any strain.
    pub bulk: Each<X>,
}

impl<X: Arithmetic> Coefficients<X> {
    /// Coefficients from a record.
    #[inline(always)]
    pub fn of(record: &[X; RECORD]) -> Self {
        let zero = X::constant(0.0);
        let mut all = Self {
            along: [[zero; 2]; 2],
            across: [[zero; 2]; 2],
            spin: [[zero; 2]; 2],
            roll: [[zero; 2]; 2],
            coupling: [[zero; 2]; 2],
            pull: [[zero; 2]; 2],
            drag: [[zero; 2]; 2],
            turn: [[zero; 2]; 2],
            push: [zero; 2],
            slide: [zero; 2],
            twist: [zero; 2],
            stretch: [zero; 2],
            bend: [zero; 2],
            bulk: [zero; 2],
        };
        let scales = Scales::of(record);
        all.set_bulk(record, &scales);
        all.set_along(record, &scales);
        all.set_spin(record, &scales);
        all.set_across(record, &scales);
        all
    }

    /// Sets coefficients from the blocks in the normal plane: `M` alone.
    #[inline(always)]
    fn set_bulk(&mut self, record: &[X; RECORD], scales: &Scales<X>) {
        let moments = scales.moments([record[34], record[35], record[36]]);
        for k in 0..2 {
            self.bulk[k] = scales.square * (moments[k][0] + moments[k][1]);
        }
    }

    /// Sets coefficients from the axial block, in gap coordinates: `w`, the rate at which the gap opens minus the
    /// effect of strain on the poles, and `c`, a mean velocity.
    #[inline(always)]
    fn set_along(&mut self, record: &[X; RECORD], scales: &Scales<X>) {
        let single = X::constant((6.0 * PI).sqrt());
        let of_mean = single * record[ROOT_OF_SUM];
        let (p, q, s) = (single * record[0], of_mean * record[1], of_mean * record[2]);
        let factor = scales.factor;
        let (ww, wc, cc) = (factor * p * p, factor * p * q, factor * (q * q + s * s));
        let share = [record[SHARE], record[SHARE] * record[RATIO]];
        let sign = [X::constant(-1.0), X::constant(1.0)];
        for k in 0..2 {
            for l in 0..2 {
                let opening = sign[k] * sign[l] * ww + (sign[k] * share[l] + sign[l] * share[k]) * wc;
                self.along[k][l] = opening + share[k] * share[l] * cc;
            }
        }
        let lever = [X::constant(LEVER), X::constant(LEVER) * record[RATIO]];
        let moments = scales.moments([record[7], record[8], record[9]]);
        let (mut gap, mut opening, mut mean) = ([ww; 2], [ww; 2], [ww; 2]);
        for k in 0..2 {
            gap[k] = factor * single * scales.strain[k] * record[3 + k];
            opening[k] = gap[k] - lever[k] * ww;
            mean[k] = factor * of_mean * scales.strain[k] * record[5 + k] - lever[k] * wc;
        }
        let (to_moment, to_tensor) = (X::constant(1.5_f64.sqrt()), X::constant(1.5_f64.sqrt() / 3.0));
        let lengths = scales.radius * to_moment;
        for k in 0..2 {
            for l in 0..2 {
                self.pull[k][l] = scales.radius * to_tensor * (sign[l] * opening[k] + share[l] * mean[k]);
            }
            self.push[k] = lengths * (sign[k] * (opening[0] + opening[1]) + share[k] * (mean[0] + mean[1]));
            let mut moment = zero(ww);
            for l in 0..2 {
                moment = moment + moments[k][l] - lever[l] * gap[k] - lever[k] * gap[l] + lever[k] * lever[l] * ww;
            }
            self.stretch[k] = X::constant(0.5) * (scales.square * moment - self.bulk[k]);
        }
    }

    #[inline(always)]
    fn set_spin(&mut self, record: &[X; RECORD], scales: &Scales<X>) {
        let root = [[record[10], record[11]], [record[11], record[12]]];
        for k in 0..2 {
            for l in 0..2 {
                let product = root[k][0] * root[l][0] + root[k][1] * root[l][1];
                self.spin[k][l] = scales.square * scales.factor * scales.turning[k] * scales.turning[l] * product;
            }
        }
    }

    /// Sets coefficients from the transverse block, in `U1, U2` and the radius times `Omega1, Omega2`.
    #[inline(always)]
    fn set_across(&mut self, record: &[X; RECORD], scales: &Scales<X>) {
        let mut root = [[record[0]; 4]; 4];
        let mut next = 13;
        for i in 0..4 {
            for j in 0..=i {
                root[i][j] = record[next];
                root[j][i] = record[next];
                next += 1;
            }
        }
        let single = [scales.moving[0], scales.moving[1], scales.turning[0], scales.turning[1]];
        let mut matrix = [[record[0]; 4]; 4];
        for i in 0..4 {
            for j in 0..=i {
                let mut product = root[i][0] * root[j][0];
                for k in 1..4 {
                    product = product + root[i][k] * root[j][k];
                }
                matrix[i][j] = scales.factor * single[i] * single[j] * product;
                matrix[j][i] = matrix[i][j];
            }
        }
        let mut coupling = [[record[0]; 2]; 4];
        for i in 0..4 {
            for k in 0..2 {
                coupling[i][k] = scales.factor * single[i] * scales.strain[k] * record[23 + 2 * i + k];
            }
        }
        let moments = scales.moments([record[31], record[32], record[33]]);
        let (root_half, root_two) = (X::constant(0.5_f64.sqrt()), X::constant(2.0_f64.sqrt()));
        for k in 0..2 {
            let (mut moved, mut turned) = (zero(record[0]), zero(record[0]));
            for l in 0..2 {
                self.across[k][l] = matrix[k][l];
                self.coupling[k][l] = scales.radius * matrix[k][2 + l];
                self.roll[k][l] = scales.square * matrix[2 + k][2 + l];
                self.drag[k][l] = scales.radius * root_half * coupling[l][k];
                self.turn[k][l] = scales.square * root_half * coupling[2 + l][k];
                moved = moved + coupling[k][l];
                turned = turned + coupling[2 + k][l];
            }
            self.slide[k] = root_two * scales.radius * moved;
            self.twist[k] = root_two * scales.square * turned;
            self.bend[k] = scales.square * (moments[k][0] + moments[k][1]) - self.bulk[k];
        }
    }
}

/// Zero for as many pairs as `like` holds.
#[inline(always)]
fn zero<X: Arithmetic>(_like: X) -> X {
    X::constant(0.0)
}

/// Square roots of the resistances of single spheres, by which the table is made dimensionless, and the dimensional
/// factors.
struct Scales<X> {
    factor: X,
    radius: X,
    square: X,
    moving: [X; 2],
    turning: [X; 2],
    strain: [X; 2],
}

impl<X: Arithmetic> Scales<X> {
    #[inline(always)]
    fn of(record: &[X; RECORD]) -> Self {
        let cubed = record[RATIO] * record[ROOT];
        let (u, o, e) = ((6.0 * PI).sqrt(), (8.0 * PI).sqrt(), (20.0 / 3.0 * PI).sqrt());
        Self {
            factor: record[FACTOR],
            radius: record[RADIUS],
            square: record[RADIUS] * record[RADIUS],
            moving: [X::constant(u), X::constant(u) * record[ROOT]],
            turning: [X::constant(o), X::constant(o) * cubed],
            strain: [X::constant(e), X::constant(e) * cubed],
        }
    }

    /// Symmetric matrix from strains to moments, from its lower triangle.
    #[inline(always)]
    fn moments(&self, lower: [X; 3]) -> [[X; 2]; 2] {
        let [first, both, second] = lower;
        let both = self.factor * self.strain[0] * self.strain[1] * both;
        let alone = [first * self.strain[0] * self.strain[0], second * self.strain[1] * self.strain[1]];
        [[self.factor * alone[0], both], [both, self.factor * alone[1]]]
    }
}
