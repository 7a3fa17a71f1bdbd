//! Resistance of a pair in the force-coupling method itself: two spheres in free space.

use domain::sphere;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crate::dense::{Square, inverse, times};
use crate::gaussian::{quadrupole, radial_derivatives, widths};
use crate::two_sphere::blocks::{ResistanceBlocks, place};
use crate::two_sphere::slip::{SLIP_VALUES, SlipFunction, SlipValues};

/// Resistance over viscosity of two spheres in free space by the force-coupling method: forces, torques and
/// stresslets with Gaussian envelopes, each block the inverse of its mobility.
///
/// The diagonal of the mobility is that of single spheres, which the envelopes reproduce exactly.
pub fn resistance(radii: [f64; 2], distance: f64) -> ResistanceBlocks {
    let envelopes = radii.map(widths);
    // Derivatives for the envelope `i` of sphere 1 (0 force, 1 dipole) and `j` of sphere 2.
    let f = [0, 1].map(|i| [0, 1].map(|j| radial_derivatives(distance, envelopes[0][i].hypot(envelopes[1][j]))));
    let own = |factor: f64, power: i32| radii.map(|a| 1.0 / (factor * PI * a.powi(power)));
    let (velocity, angular, strain) = (own(6.0, 1), own(8.0, 3), own(20.0 / 3.0, 3));
    ResistanceBlocks {
        axial: axial(distance, &f, velocity, strain),
        spin: inverse(symmetric(angular, 0.5 * (5.0 * f[1][1][1] + distance.powi(2) * f[1][1][2]))),
        transverse: transverse(distance, &f, [velocity, angular, strain]),
        planar: inverse(symmetric(strain, 3.0 * f[1][1][1] + distance.powi(2) * f[1][1][2])),
    }
}

/// Loads over viscosity of two spheres at rest by slip, by the force-coupling method: squirmers apply degenerate
/// quadrupoles `H = -4/3 pi a^3 b`, have the velocity `2/3 b` besides that by the loads and quadrupoles of others, and
/// the rate of strain `-3 Q/(5 a)`. At rest, the loads are the resistance times minus these velocities.
pub fn slip(radii: [f64; 2], distance: f64) -> SlipValues {
    let resistance = resistance(radii, distance);
    let mut values = [0.0; SLIP_VALUES];
    for slips in 0..2 {
        let other = 1 - slips;
        let flow = QuadrupoleFlow::new([radii[slips], radii[other]], distance);
        let sign = if other == 1 { 1.0 } else { -1.0 };
        let strain = -3.0 / (5.0 * radii[slips]);
        let mut axial = [[0.0; 4]; 2];
        axial[0][slips] = -2.0 / 3.0;
        axial[0][other] = -flow.along;
        axial[0][2 + other] = -sign * flow.stretching * 1.5_f64.sqrt();
        axial[1][2 + slips] = strain * (2.0 / 3.0) * 1.5_f64.sqrt();
        let mut transverse = [[0.0; 6]; 2];
        transverse[0][slips] = -2.0 / 3.0;
        transverse[0][other] = -flow.across;
        transverse[0][2 + other] = -sign * flow.turning;
        transverse[0][4 + other] = -sign * flow.shearing * 2.0_f64.sqrt();
        transverse[1][4 + slips] = strain * 2.0_f64.sqrt();
        let (axial, transverse) =
            (axial.map(|m| times(&resistance.axial, &m)), transverse.map(|m| times(&resistance.transverse, &m)));
        for bears in 0..2 {
            let mut put =
                |function: SlipFunction, value: f64| values[4 * function as usize + 2 * bears + slips] = value;
            put(SlipFunction::XF1, axial[0][bears]);
            put(SlipFunction::XS1, axial[0][2 + bears] / 1.5_f64.sqrt());
            put(SlipFunction::XF2, axial[1][bears]);
            put(SlipFunction::XS2, axial[1][2 + bears] / 1.5_f64.sqrt());
            put(SlipFunction::YF1, transverse[0][bears]);
            put(SlipFunction::YT1, transverse[0][2 + bears]);
            put(SlipFunction::YS1, transverse[0][4 + bears] * FRAC_1_SQRT_2);
            put(SlipFunction::YF2, transverse[1][bears]);
            put(SlipFunction::YT2, transverse[1][2 + bears]);
            put(SlipFunction::YS2, transverse[1][4 + bears] * FRAC_1_SQRT_2);
            put(SlipFunction::ZS2, resistance.planar[bears][slips] * strain);
        }
    }
    values
}

/// Flow of the quadrupole of a unit slip `b` at another sphere at a distance along `z`, averaged over its envelopes.
struct QuadrupoleFlow {
    /// Velocity `u_z` by `b = z`, and `u_x` by `b = x`.
    along: f64,
    across: f64,
    /// `E_zz` by `b = z`, `E_xz` and `Omega_y` by `b = x`.
    stretching: f64,
    shearing: f64,
    turning: f64,
}

impl QuadrupoleFlow {
    /// For the radii of the sphere that slips and of the other.
    fn new([slips, other]: [f64; 2], r: f64) -> Self {
        let (variances, weight) = quadrupole(slips);
        let strength = -sphere::volume(slips) * weight;
        let difference = |width: f64| -> [f64; 4] {
            let [wide, narrow] = variances.map(|variance| radial_derivatives(r, variance.sqrt().hypot(width)));
            std::array::from_fn(|n| strength * (wide[n] - narrow[n]))
        };
        let [velocity, gradient] = widths(other).map(difference);
        let r2 = r * r;
        Self {
            along: -2.0 * velocity[0],
            across: -2.0 * velocity[0] - r2 * velocity[1],
            stretching: -2.0 * r * gradient[1],
            shearing: -0.5 * r * (3.0 * gradient[1] + r2 * gradient[2]),
            turning: -0.5 * r * (5.0 * gradient[1] + r2 * gradient[2]),
        }
    }
}

/// Mobility times viscosity along the line of centres with forces alone.
pub fn axial_mobility(radii: [f64; 2], distance: f64) -> Square<2> {
    let [first, second] = radii.map(|radius| widths(radius)[0]);
    let mutual = -2.0 * radial_derivatives(distance, first.hypot(second))[0];
    symmetric(radii.map(|radius| 1.0 / sphere::drag(1.0, radius)), mutual)
}

type Derivatives = [[[f64; 4]; 2]; 2];

fn axial(r: f64, f: &Derivatives, velocity: [f64; 2], strain: [f64; 2]) -> Square<4> {
    let mut mobility = [[0.0; 4]; 4];
    place(&mut mobility, 0, 0, symmetric(velocity, -2.0 * f[0][0][0]));
    place(&mut mobility, 2, 2, symmetric(strain, 3.0 * (f[1][1][1] + r * r * f[1][1][2])));
    // The strain of sphere 1 by the force on sphere 2 has the opposite sign of the reverse.
    let rate = |f: &[f64; 4]| -2.0 * r * f[1] * 1.5_f64.sqrt();
    place(&mut mobility, 2, 0, [[0.0, -rate(&f[1][0])], [rate(&f[0][1]), 0.0]]);
    inverse(mobility)
}

fn transverse(r: f64, f: &Derivatives, [velocity, angular, strain]: [[f64; 2]; 3]) -> Square<6> {
    let (r2, r4, dipoles) = (r * r, r.powi(4), &f[1][1]);
    let turn = |f: &[f64; 4]| -0.5 * r * (5.0 * f[1] + r2 * f[2]);
    let rate = |f: &[f64; 4]| -0.5 * r * (3.0 * f[1] + r2 * f[2]) * 2.0_f64.sqrt();
    let mut mobility = [[0.0; 6]; 6];
    place(&mut mobility, 0, 0, symmetric(velocity, -2.0 * f[0][0][0] - r2 * f[0][0][1]));
    place(&mut mobility, 2, 0, [[0.0, -turn(&f[1][0])], [turn(&f[0][1]), 0.0]]);
    place(
        &mut mobility,
        2,
        2,
        symmetric(angular, 0.25 * (10.0 * dipoles[1] + 9.0 * r2 * dipoles[2] + r4 * dipoles[3])),
    );
    place(&mut mobility, 4, 0, [[0.0, -rate(&f[1][0])], [rate(&f[0][1]), 0.0]]);
    let mixed = 0.5_f64.sqrt() * 0.5 * (7.0 * r2 * dipoles[2] + r4 * dipoles[3]);
    place(&mut mobility, 4, 2, [[0.0, mixed], [mixed, 0.0]]);
    place(&mut mobility, 4, 4, symmetric(strain, 0.5 * (6.0 * dipoles[1] + 5.0 * r2 * dipoles[2] + r4 * dipoles[3])));
    inverse(mobility)
}

fn symmetric(own: [f64; 2], mutual: f64) -> Square<2> {
    [[own[0], mutual], [mutual, own[1]]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Far apart the envelopes are points: a torque along the line of centres causes an angular velocity of
    /// `1 / (8 pi r^3)` times it at a distance `r`.
    #[test]
    fn spheres_far_apart_turn_each_other_as_points_do() {
        let distance = 20.0;
        let mobility = inverse(resistance([1.0, 1.5], distance).spin);
        let expected = 1.0 / (8.0 * PI * distance.powi(3));
        for (row, column) in [(0, 1), (1, 0)] {
            assert!((mobility[row][column] / expected - 1.0).abs() < 1e-9, "{}", mobility[row][column]);
        }
    }
}
