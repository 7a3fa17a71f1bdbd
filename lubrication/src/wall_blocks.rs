//! The 11 x 11 resistance matrix of a sphere at a plane wall, in blocks by azimuthal order about the wall's normal.

use std::f64::consts::PI;

use crate::dense::{Square, inverse, times};
use crate::gaussian::widths;
use crate::two_sphere::slip::SLIP_FUNCTIONS;
use crate::two_sphere::{Function, WallFunctions};

/// Resistance over viscosity of a sphere of radius 1: its loads on the fluid against its motions, as in
/// [`ResistanceBlocks`](crate::two_sphere::blocks::ResistanceBlocks) with `d = e_z` from the centre to the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallBlocks {
    /// `(U, e)` along the normal.
    pub axial: Square<2>,
    /// `Omega` along the normal.
    pub spin: Square<1>,
    /// `(U, Omega, e)` along the wall; twice, for `x` and for `y`.
    pub transverse: Square<3>,
    /// `e` in the plane of the wall; twice.
    pub planar: Square<1>,
}

/// Resistances of an isolated sphere of radius 1 to translation, rotation and strain, over viscosity.
pub const ISOLATED: [f64; 3] = [6.0 * PI, 8.0 * PI, 20.0 / 3.0 * PI];

impl WallBlocks {
    /// Exact resistance from its scalar functions.
    pub fn exact(f: &WallFunctions) -> Self {
        let [force, torque, strain] = ISOLATED;
        let [b, g, h] = [-4.0, 4.0 * 2.0_f64.sqrt(), 8.0 * 2.0_f64.sqrt()].map(|factor| factor * PI);
        let xg = 4.0 * PI * (2.0_f64 / 3.0).sqrt() * f[Function::XG];
        let (yb, yg, yh) = (b * f[Function::YB], g * f[Function::YG], h * f[Function::YH]);
        Self {
            axial: [[force * f[Function::XA], xg], [xg, strain * f[Function::XM]]],
            spin: [[torque * f[Function::XC]]],
            transverse: [
                [force * f[Function::YA], yb, yg],
                [yb, torque * f[Function::YC], yh],
                [yg, yh, strain * f[Function::YM]],
            ],
            planar: [[strain * f[Function::ZM]]],
        }
    }

    /// Resistance of the force-coupling method for a sphere at a distance `z` of its centre from a wall: each block
    /// the inverse of its mobility, that of the isolated sphere and of its image (Blake 1971).
    ///
    /// The image's flow at and above the wall is biharmonic, so the envelopes of widths `s` of the force and `d` of
    /// torque and stresslet act on it as `1 + (s²/2) lap` exactly, also where they extend through the wall. The
    /// integrals over wavevectors along the wall of powers of `k` times `exp(-2 k z)` are powers of `1/z`.
    pub fn of_fcm(z: f64) -> Self {
        let [s, d] = widths(1.0).map(|width| width * width);
        let [force, torque, strain] = ISOLATED.map(|resistance| 1.0 / resistance);
        let power = |n: i32| z.powi(-n) / PI;
        let sum = |terms: &[(i32, f64)]| terms.iter().map(|&(n, factor)| factor * power(n)).sum::<f64>();
        let [root2, root6] = [2.0_f64.sqrt(), 6.0_f64.sqrt()];
        // Velocity and rate of strain by the other's load. The axis points to the wall, which decides the sign of odd
        // functions.
        let stretch = -root6 * sum(&[(2, 3.0 / 64.0), (4, -(15.0 * d + 9.0 * s) / 128.0), (6, 15.0 / 64.0 * d * s)]);
        let shear = -root2 * sum(&[(2, 3.0 / 64.0), (4, -9.0 / 128.0 * (d + s)), (6, 15.0 / 64.0 * d * s)]);
        let turn = -sum(&[(4, 3.0 / 64.0 * s)]);
        let mixed = root2 * sum(&[(3, 3.0 / 128.0), (5, -3.0 / 32.0 * d)]);
        let along = sum(&[(1, -3.0 / 16.0), (3, s / 4.0), (5, -3.0 / 16.0 * s * s)]);
        let across = sum(&[(1, -3.0 / 32.0), (3, s / 16.0), (5, -3.0 / 32.0 * s * s)]);
        let stretched = sum(&[(3, -3.0 / 16.0), (5, 9.0 / 8.0 * d), (7, -135.0 / 64.0 * d * d)]);
        let sheared = sum(&[(3, -9.0 / 64.0), (5, 3.0 / 4.0 * d), (7, -45.0 / 32.0 * d * d)]);
        let planar = sum(&[(3, -3.0 / 64.0), (5, 3.0 / 16.0 * d), (7, -45.0 / 128.0 * d * d)]);
        Self {
            axial: inverse([[force + along, stretch], [stretch, strain + stretched]]),
            spin: inverse([[torque + sum(&[(3, -1.0 / 64.0)])]]),
            transverse: inverse([
                [force + across, turn, shear],
                [turn, torque + sum(&[(3, -5.0 / 128.0)]), mixed],
                [shear, mixed, strain + sheared],
            ]),
            planar: inverse([[strain + planar]]),
        }
    }
}

/// Loads over viscosity of a squirmer of radius 1 at rest by its slip, by the force-coupling method, at a distance `z`
/// of its centre from a wall, in the order of
/// [`SlipFunction::ALL`](crate::two_sphere::SlipFunction::ALL): the resistance times minus the velocity `2/3 b`
/// and the rate of strain `-3/5 Q`, as [`far_field::slip`](crate::far_field::slip), and minus the motion by the image
/// of the degenerate quadrupole `H = -4/3 pi b`. That image is twice the derivative of the image of a force with
/// respect to the variance of its envelope, since `lap` acts on the biharmonic flow of walls in place of
/// `1 + (s²/2) lap`.
pub fn slip_of_fcm(z: f64) -> [f64; SLIP_FUNCTIONS] {
    let [s, d] = widths(1.0).map(|width| width * width);
    let resistance = WallBlocks::of_fcm(z);
    let (strength, strain) = (-4.0 / 3.0, -0.6);
    let sum = |terms: &[(i32, f64)]| strength * terms.iter().map(|&(n, factor)| factor * z.powi(-n)).sum::<f64>();
    let [root2, root3_2] = [2.0_f64.sqrt(), 1.5_f64.sqrt()];
    let stretching = -2.0 * root3_2 * sum(&[(4, -9.0 / 64.0), (6, 15.0 / 32.0 * d)]);
    let shearing = -root2 * sum(&[(4, -9.0 / 64.0), (6, 15.0 / 32.0 * d)]);
    let turning = -sum(&[(4, 3.0 / 32.0)]);
    let along = sum(&[(3, 0.25), (5, -3.0 / 8.0 * s)]);
    let across = sum(&[(3, 1.0 / 16.0), (5, -3.0 / 16.0 * s)]);
    let axial = [[-2.0 / 3.0 - along, -stretching], [0.0, strain / root3_2]].map(|m| times(&resistance.axial, &m));
    let transverse = [[-2.0 / 3.0 - across, -turning, -shearing], [0.0, 0.0, strain * root2]]
        .map(|m| times(&resistance.transverse, &m));
    [
        axial[0][0],
        axial[0][1] / root3_2,
        axial[1][0],
        axial[1][1] / root3_2,
        transverse[0][0],
        transverse[0][1],
        transverse[0][2] / root2,
        transverse[1][0],
        transverse[1][1],
        transverse[1][2] / root2,
        resistance.planar[0][0] * strain,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::two_sphere::SphereWall;
    use crate::two_sphere::slip::wall_loads;

    fn exact(distance: f64) -> WallBlocks {
        WallBlocks::exact(&SphereWall::get().resistance(distance - 1.0).unwrap())
    }

    /// Ratios of the method's XA, YA, YC and XM to exact ones, by quadrature of the kernel over wavevectors with
    /// Gaussian envelopes: distances have four digits and ratios three.
    #[test]
    fn the_method_is_off_near_the_wall_as_its_kernel_says() {
        let table = [
            (1.0453, [0.253, 0.839, 0.827, 0.175]),
            (1.25, [0.803, 0.970, 0.976, 0.720]),
            (1.5431, [0.967, 0.994, 0.996, 0.940]),
            (2.0, [0.998, 0.999, 1.000, 0.991]),
            (3.76, [1.0005, 1.0001, 1.0, 0.9999]),
        ];
        for (distance, expected) in table {
            let (exact, known) = (exact(distance), WallBlocks::of_fcm(distance));
            let pairs = [
                (known.axial[0][0], exact.axial[0][0]),
                (known.transverse[0][0], exact.transverse[0][0]),
                (known.transverse[1][1], exact.transverse[1][1]),
                (known.axial[1][1], exact.axial[1][1]),
            ];
            for ((known, exact), expected) in pairs.into_iter().zip(expected) {
                assert!((known / exact - expected).abs() < 6e-4, "{distance}: {}, not {expected}", known / exact);
            }
        }
    }

    /// Far from the wall the method is exact up to multipoles of rigid spheres beyond stresslets, and to Gaussians of
    /// variance `1/pi` in place of surfaces of `1/3`: of order `z^-3` for velocities.
    #[test]
    fn the_method_is_exact_far_from_the_wall() {
        for (distance, allowed) in [(4.0, 6e-4), (8.0, 6e-5)] {
            let (exact, known) = (exact(distance), WallBlocks::of_fcm(distance));
            let blocks = [
                (exact.axial.as_flattened(), known.axial.as_flattened()),
                (exact.spin.as_flattened(), known.spin.as_flattened()),
                (exact.transverse.as_flattened(), known.transverse.as_flattened()),
                (exact.planar.as_flattened(), known.planar.as_flattened()),
            ];
            for (k, (exact, known)) in blocks.into_iter().enumerate() {
                for (e, n) in exact.iter().zip(known) {
                    let off = (e - n).abs();
                    assert!(off < allowed * ISOLATED[0] && off < 0.06 * e.abs(), "{distance}, block {k}: {n}, not {e}");
                }
            }
        }
    }
    /// Far from the wall, up to the flow of the second mode that falls like `r^-4`, which the method has not.
    #[test]
    fn loads_by_slip_are_exact_far_from_the_wall() {
        for (z, allowed) in [(4.0, 4e-3), (8.0, 3e-4)] {
            let (exact, known) = (wall_loads(z - 1.0), slip_of_fcm(z));
            for (k, (exact, known)) in exact.into_iter().zip(known).enumerate() {
                let off = (exact - known).abs();
                assert!(off < allowed * 4.0 * PI && off < 0.1 * exact.abs(), "{z}, function {k}: {known}, not {exact}");
            }
        }
    }
}
