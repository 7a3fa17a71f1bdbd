//! Loads of one sphere of a pair by slip.

use std::ops::Range;

use domain::{Traceless, Vector};

use crate::arithmetic::Arithmetic;
use crate::sphere_motion::SphereLoads;
use crate::surface_slip::SurfaceSlip;
use crate::two_sphere::slip::{SlipFunction, SlipValues};

/// Count of the coefficients by the slip of both spheres, and of the factors of forces and of moments.
pub const SLIP_ROW: usize = 2 * SLIP_COEFFICIENTS + 2;

/// Count of the coefficients by the slip of one sphere.
const SLIP_COEFFICIENTS: usize = 11;

/// Count of the numbers of a slip.
pub const SLIP_NUMBERS: usize = 8;

/// Count of the loads: force, torque and first moment.
pub const LOADS: usize = 11;

/// Coefficients of the loads of one sphere of a pair by slip. With the unit vector `d` from the sphere to the other,
/// and for each slip `b`, `Q` of the sphere itself and of the other `u = b.d`, `v = Q.d` and `w = d.Q.d`, the loads are
/// sums over both slips,
///
/// ```text
/// force  = (A1 u + A2 w) d + B1 b + B2 v
/// torque = d x (C1 b + C2 v)
/// moment = (M1 u + M2 w) (d d - I/3) + d n + n d - 2/3 d.n I + Z Q,      n = N1 b + N2 v
/// ```
#[derive(Debug, Clone, Copy)]
pub struct SlipRow<X> {
    /// `A1`, `A2`, `B1`, `B2`, `C1`, `C2`, `M1`, `M2`, `N1`, `N2`, `Z`, by the sphere's own slip and by that of the
    /// other.
    by: [[X; SLIP_COEFFICIENTS]; 2],
    of_force: X,
    of_moment: X,
}

/// Sums over both slips.
struct SlipSums<X> {
    along: X,
    stretch: X,
    force: [X; 3],
    turning: [X; 3],
    shear: [X; 3],
    moment: [X; 5],
}

impl SlipRow<f64> {
    /// Coefficients of sphere `own`, 0 for the smaller one and 1 for the larger, from the values of the functions,
    /// whose axis points from the smaller to the larger sphere.
    pub fn of(values: &SlipValues, own: usize) -> Self {
        // The axis of the coefficients points to the other sphere.
        let sign = if own == 0 { 1.0 } else { -1.0 };
        let by = [own, 1 - own].map(|slips| {
            let value = |function: SlipFunction| function.of(values, own, slips);
            let [xf1, xf2] = [SlipFunction::XF1, SlipFunction::XF2].map(value);
            let [yf1, yf2] = [SlipFunction::YF1, SlipFunction::YF2].map(value);
            let [yt1, yt2] = [SlipFunction::YT1, SlipFunction::YT2].map(value);
            let [xs1, xs2] = [SlipFunction::XS1, SlipFunction::XS2].map(value);
            let [ys1, ys2, zs2] = [SlipFunction::YS1, SlipFunction::YS2, SlipFunction::ZS2].map(value);
            [
                xf1 - yf1,
                sign * (1.5 * xf2 - yf2),
                yf1,
                sign * yf2,
                sign * yt1,
                yt2,
                sign * (1.5 * xs1 - 2.0 * ys1),
                2.25 * xs2 - 2.0 * ys2 + 0.5 * zs2,
                sign * ys1,
                ys2 - zs2,
                zs2,
            ]
        });
        Self { by, of_force: 1.0, of_moment: 1.0 }
    }

    /// The coefficients and factors as a list.
    pub fn numbers(&self) -> [f64; SLIP_ROW] {
        let mut numbers = [0.0; SLIP_ROW];
        numbers[..2 * SLIP_COEFFICIENTS].copy_from_slice(self.by.as_flattened());
        numbers[2 * SLIP_COEFFICIENTS..].copy_from_slice(&[self.of_force, self.of_moment]);
        numbers
    }
}

impl<X: Arithmetic> SlipRow<X> {
    /// Places of the factors of forces and of moments in a list of numbers.
    pub const FACTORS: Range<usize> = 2 * SLIP_COEFFICIENTS..SLIP_ROW;

    /// The coefficients and factors in a list.
    #[inline(always)]
    pub fn from_numbers(numbers: &[X; SLIP_ROW]) -> Self {
        let mut by = [[X::constant(0.0); SLIP_COEFFICIENTS]; 2];
        for k in 0..2 * SLIP_COEFFICIENTS {
            by[k / SLIP_COEFFICIENTS][k % SLIP_COEFFICIENTS] = numbers[k];
        }
        let [of_force, of_moment] = [numbers[2 * SLIP_COEFFICIENTS], numbers[2 * SLIP_COEFFICIENTS + 1]];
        Self { by, of_force, of_moment }
    }

    /// Loads of the sphere for the axis `d` and the numbers of both slips: the components of force and torque, and
    /// five of the moment.
    #[inline(always)]
    pub fn loads(&self, d: [X; 3], slips: &[[X; SLIP_NUMBERS]; 2]) -> [X; LOADS] {
        let zero = X::constant(0.0);
        let mut sums = SlipSums {
            along: zero,
            stretch: zero,
            force: [zero; 3],
            turning: [zero; 3],
            shear: [zero; 3],
            moment: [zero; 5],
        };
        for k in 0..2 {
            sums.add(&self.by[k], d, &slips[k]);
        }
        let SlipSums { along, stretch, force, turning, shear, moment } = sums;
        let isotropic = stretch.plus(X::constant(2.0), dot(d, shear)) * X::constant(1.0 / 3.0);
        let mut loads = [zero; LOADS];
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            loads[i] = force[i].plus(along, d[i]) * self.of_force;
            loads[3 + i] = (d[j] * turning[k] - d[k] * turning[j]) * self.of_moment;
        }
        for (k, (i, j)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2)].into_iter().enumerate() {
            let sum = moment[k].plus(stretch * d[i], d[j]).plus(d[i], shear[j]).plus(shear[i], d[j]);
            loads[6 + k] = (if i == j { sum - isotropic } else { sum }) * self.of_moment;
        }
        loads
    }
}

impl<X: Arithmetic> SlipSums<X> {
    /// Adds the slip of one sphere.
    #[inline(always)]
    fn add(&mut self, by: &[X; SLIP_COEFFICIENTS], d: [X; 3], &[bx, by_, bz, xx, xy, xz, yy, yz]: &[X; SLIP_NUMBERS]) {
        let [a1, a2, b1, b2, c1, c2, m1, m2, n1, n2, z] = *by;
        let (b, zz) = ([bx, by_, bz], X::constant(0.0) - xx - yy);
        let v = [dot([xx, xy, xz], d), dot([xy, yy, yz], d), dot([xz, yz, zz], d)];
        let (u, w) = (dot(b, d), dot(v, d));
        self.along = self.along.plus(a1, u).plus(a2, w);
        self.stretch = self.stretch.plus(m1, u).plus(m2, w);
        for k in 0..3 {
            self.force[k] = self.force[k].plus(b1, b[k]).plus(b2, v[k]);
            self.turning[k] = self.turning[k].plus(c1, b[k]).plus(c2, v[k]);
            self.shear[k] = self.shear[k].plus(n1, b[k]).plus(n2, v[k]);
        }
        for (moment, component) in self.moment.iter_mut().zip([xx, xy, xz, yy, yz]) {
            *moment = moment.plus(z, component);
        }
    }
}

#[inline(always)]
fn dot<X: Arithmetic>(a: [X; 3], b: [X; 3]) -> X {
    (a[0] * b[0]).plus(a[1], b[1]).plus(a[2], b[2])
}

impl SurfaceSlip {
    /// Components of both modes.
    #[inline(always)]
    pub fn numbers(&self) -> [f64; SLIP_NUMBERS] {
        let ([bx, by, bz], [xx, xy, xz, yy, yz]) = (self.first.to_array(), self.second.0);
        [bx, by, bz, xx, xy, xz, yy, yz]
    }
}

impl SphereLoads {
    /// Loads with these components of force, torque and moment.
    #[inline(always)]
    pub fn from_numbers(&[fx, fy, fz, tx, ty, tz, ref moment @ ..]: &[f64; LOADS]) -> Self {
        Self { force: Vector::new(fx, fy, fz), torque: Vector::new(tx, ty, tz), moment: Traceless(*moment) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface_slip::loads_by_modes;
    use crate::two_sphere::slip::SLIP_VALUES;

    /// The loads are those of the modes along the axis, for arbitrary values of the functions.
    #[test]
    fn loads_are_those_of_the_modes() {
        let values: SlipValues = std::array::from_fn(|k| (1.0 + (7 * k % SLIP_VALUES) as f64).sin());
        let slips = [
            SurfaceSlip { first: Vector::new(0.3, -1.0, 0.4), second: Traceless([0.2, -0.5, 0.1, 0.7, 0.3]) },
            SurfaceSlip { first: Vector::new(-0.6, 0.2, 1.1), second: Traceless([-0.4, 0.6, 0.9, 0.1, -0.2]) },
        ];
        let d = Vector::new(1.0, -1.4, 0.6).normalize();
        for own in [0, 1] {
            let mut numbers = SlipRow::of(&values, own).numbers();
            numbers[SlipRow::<f64>::FACTORS].copy_from_slice(&[2.0, 3.0]);
            let found = SlipRow::from_numbers(&numbers).loads(d.to_array(), &slips.map(|slip| slip.numbers()));
            let found = SphereLoads::from_numbers(&found);
            let axis = if own == 0 { d } else { -d };
            let by = |slips_at: usize, slip| loads_by_modes(axis, |f| f.of(&values, own, slips_at), slip);
            let expected = by(own, &slips[0]) + by(1 - own, &slips[1]);
            assert!((found.force - expected.force * 2.0).length() < 1e-13, "{own}: {found:?}");
            assert!((found.torque - expected.torque * 3.0).length() < 1e-13, "{own}: {found:?}");
            let rest = found.moment - expected.moment * 3.0;
            assert!(rest.contract(rest).sqrt() < 1e-13, "{own}: {found:?}");
        }
    }
}
