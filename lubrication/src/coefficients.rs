//! Lubrication resistance of a pair as coefficients of tensors of its axis.

use std::f64::consts::PI;

use crate::arithmetic::Arithmetic;
use crate::block_factor::LANES;
use crate::pair_factor::LEVER;

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
/// F = xa (z.U) z + ya (U - (z.U) z) + yb Omega x z
/// L = xc (z.Omega) z + yc (Omega - (z.Omega) z) + yb' z x U
/// M = xg (z.U) (3 zz - 1) + z s + s z,        s = yg (U - (z.U) z) + yh Omega x z
/// ```
///
/// with `yb'` the coefficient for the two spheres exchanged. A rate of strain `E` of both relative to the ambient
/// flow, with `t = E z - (z.E z) z`, adds
///
/// ```text
/// F = xg_strain (z.E z) z + yg_strain t,        L = yh_strain z x t
/// M = zm E + xm_minus_zm_half (z.E z) (3 zz - 1) + ym_minus_zm (z t + t z)
/// ```
///
/// The names are those of the resistance functions of Jeffrey & Onishi (1984) and Jeffrey (1992), to which the
/// coefficients are proportional, with constant factors and powers of the radii. Values by strain are sums over the
/// sphere that strains.
///
/// | load | by `U` along `z` | by `U` across | by `Omega` along `z` | by `Omega` across | by `E` |
/// |---|---|---|---|---|---|
/// | force | `xa` | `ya` | | `yb` | `xg_strain`, `yg_strain` |
/// | torque | | `yb'` | `xc` | `yc` | `yh_strain` |
/// | first moment | `xg` | `yg` | | `yh` | `zm`, `ym_minus_zm`, `xm_minus_zm_half` |
#[derive(Debug, Clone, Copy)]
pub struct Coefficients<X> {
    /// `X^A`: force by velocity along the axis.
    pub xa: Both<X>,
    /// `Y^A`: force by velocity normal to the axis.
    pub ya: Both<X>,
    /// `X^C`: torque by angular velocity along the axis.
    pub xc: Both<X>,
    /// `Y^C`: torque by angular velocity normal to the axis.
    pub yc: Both<X>,
    /// `Y^B`: force by angular velocity.
    pub yb: Both<X>,
    /// `X^G`: first moment by velocity along the axis.
    pub xg: Both<X>,
    /// `Y^G`: first moment by velocity normal to the axis.
    pub yg: Both<X>,
    /// `Y^H`: first moment by angular velocity.
    pub yh: Both<X>,
    /// `X^G`: force along the axis by strain.
    pub xg_strain: Each<X>,
    /// `Y^G`: force normal to the axis by strain.
    pub yg_strain: Each<X>,
    /// `Y^H`: torque by strain.
    pub yh_strain: Each<X>,
    /// `(X^M - Z^M)/2`: first moment by strain along the axis, in addition to `zm`.
    pub xm_minus_zm_half: Each<X>,
    /// `Y^M - Z^M`: first moment by shear between the axis and its normal plane, in addition to `zm`.
    pub ym_minus_zm: Each<X>,
    /// `Z^M`: first moment by any strain.
    pub zm: Each<X>,
}

impl<X: Arithmetic> Coefficients<X> {
    /// Coefficients from a record.
    #[inline(always)]
    pub fn of(record: &[X; RECORD]) -> Self {
        let zero = X::constant(0.0);
        let mut all = Self {
            xa: [[zero; 2]; 2],
            ya: [[zero; 2]; 2],
            xc: [[zero; 2]; 2],
            yc: [[zero; 2]; 2],
            yb: [[zero; 2]; 2],
            xg: [[zero; 2]; 2],
            yg: [[zero; 2]; 2],
            yh: [[zero; 2]; 2],
            xg_strain: [zero; 2],
            yg_strain: [zero; 2],
            yh_strain: [zero; 2],
            xm_minus_zm_half: [zero; 2],
            ym_minus_zm: [zero; 2],
            zm: [zero; 2],
        };
        let scales = CoefficientScales::of(record);
        all.set_planar(record, &scales);
        all.set_axial(record, &scales);
        all.set_spin(record, &scales);
        all.set_transverse(record, &scales);
        all
    }

    /// Sets coefficients from the blocks in the normal plane: `M` alone.
    #[inline(always)]
    fn set_planar(&mut self, record: &[X; RECORD], scales: &CoefficientScales<X>) {
        let moments = scales.moments([record[34], record[35], record[36]]);
        for k in 0..2 {
            self.zm[k] = scales.square * (moments[k][0] + moments[k][1]);
        }
    }

    /// Sets coefficients from the axial block, in gap coordinates: `w`, the rate at which the gap opens minus the
    /// effect of strain on the poles, and `c`, a mean velocity.
    #[inline(always)]
    fn set_axial(&mut self, record: &[X; RECORD], scales: &CoefficientScales<X>) {
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
                self.xa[k][l] = opening + share[k] * share[l] * cc;
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
                self.xg[k][l] = scales.radius * to_tensor * (sign[l] * opening[k] + share[l] * mean[k]);
            }
            self.xg_strain[k] = lengths * (sign[k] * (opening[0] + opening[1]) + share[k] * (mean[0] + mean[1]));
            let mut moment = zero(ww);
            for l in 0..2 {
                moment = moment + moments[k][l] - lever[l] * gap[k] - lever[k] * gap[l] + lever[k] * lever[l] * ww;
            }
            self.xm_minus_zm_half[k] = X::constant(0.5) * (scales.square * moment - self.zm[k]);
        }
    }

    #[inline(always)]
    fn set_spin(&mut self, record: &[X; RECORD], scales: &CoefficientScales<X>) {
        let root = [[record[10], record[11]], [record[11], record[12]]];
        for k in 0..2 {
            for l in 0..2 {
                let product = root[k][0] * root[l][0] + root[k][1] * root[l][1];
                self.xc[k][l] = scales.square * scales.factor * scales.turning[k] * scales.turning[l] * product;
            }
        }
    }

    /// Sets coefficients from the transverse block, in `U1, U2` and the radius times `Omega1, Omega2`.
    #[inline(always)]
    fn set_transverse(&mut self, record: &[X; RECORD], scales: &CoefficientScales<X>) {
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
                self.ya[k][l] = matrix[k][l];
                self.yb[k][l] = scales.radius * matrix[k][2 + l];
                self.yc[k][l] = scales.square * matrix[2 + k][2 + l];
                self.yg[k][l] = scales.radius * root_half * coupling[l][k];
                self.yh[k][l] = scales.square * root_half * coupling[2 + l][k];
                moved = moved + coupling[k][l];
                turned = turned + coupling[2 + k][l];
            }
            self.yg_strain[k] = root_two * scales.radius * moved;
            self.yh_strain[k] = root_two * scales.square * turned;
            self.ym_minus_zm[k] = scales.square * (moments[k][0] + moments[k][1]) - self.zm[k];
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
struct CoefficientScales<X> {
    factor: X,
    radius: X,
    square: X,
    moving: [X; 2],
    turning: [X; 2],
    strain: [X; 2],
}

impl<X: Arithmetic> CoefficientScales<X> {
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
