//! Resistance of a pair in the force-coupling method itself: two spheres in free space.

use domain::sphere;
use std::f64::consts::PI;

use crate::dense::{Square, inverse};
use crate::gaussian::{radial_derivatives, widths};
use crate::two_sphere::blocks::{ResistanceBlocks, place};

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
