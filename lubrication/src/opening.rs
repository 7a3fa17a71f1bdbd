//! Relative mobility of a near pair along its line of centres.

use crate::dense::inverse;
use crate::far_field;
use crate::two_sphere::blocks::{Blocks, part};
use crate::two_sphere::{TwoSphere, TwoSphereError};
use domain::power_of_two;

/// Model of the hydrodynamics of a near pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// Monopoles alone: spheres need not be rigid.
    Forces,
    /// The force-coupling method with its stresslets.
    Rigid,
    /// The exact solution, as with lubrication.
    Exact,
}

/// Velocity at which two spheres in unbounded fluid separate under opposite unit forces along their line of centres,
/// times the viscosity: `x_11 + x_22 - 2 x_12` of the axial mobilities.
pub fn opening_mobility(radii: [f64; 2], gap: f64, detail: Detail) -> Result<f64, TwoSphereError> {
    // In units of length in which the radii are about 1; a mobility times viscosity is an inverse length.
    let unit = power_of_two(radii[0].min(radii[1]));
    let (radii, gap) = (radii.map(|radius| radius / unit), gap / unit);
    let distance = radii[0] + radii[1] + gap;
    let mobility = match detail {
        Detail::Forces => far_field::axial_mobility(radii, distance),
        Detail::Rigid => inverse(part(&far_field::resistance(radii, distance).axial, (0, 0))),
        Detail::Exact => {
            let (small, large) = (radii[0].min(radii[1]), radii[0].max(radii[1]));
            let exact = TwoSphere::with_ratio(large / small)?.at(gap / small);
            inverse(part(&Blocks::exact(&exact, [small, large]).axial, (0, 0)))
        }
    };
    Ok((mobility[0][0] + mobility[1][1] - 2.0 * mobility[0][1]) / unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn far_spheres_give_way_alone() {
        let alone = (1.0 + 0.5) / (6.0 * PI);
        for detail in [Detail::Forces, Detail::Rigid, Detail::Exact] {
            for radii in [[1.0, 2.0], [2.0, 1.0]] {
                let found = opening_mobility(radii, 1e4, detail).unwrap();
                assert!((found / alone - 1.0).abs() < 1e-3, "{detail:?}: {found}, alone {alone}");
            }
        }
    }

    #[test]
    fn exact_spheres_near_contact_give_way_in_proportion_to_the_gap() {
        // A force of 3/2 pi a^2 V / h for equal spheres that separate with the velocity V.
        let found = opening_mobility([2.0; 2], 2e-5, Detail::Exact).unwrap();
        assert!((found / (2e-5 / (1.5 * PI * 4.0)) - 1.0).abs() < 1e-3, "{found}");
    }

    #[test]
    fn in_other_units_of_length_they_give_way_alike() {
        for detail in [Detail::Forces, Detail::Rigid, Detail::Exact] {
            let one = opening_mobility([1.0, 1.5], 0.05, detail).unwrap();
            for length in [1e-50, 1e-30, 3e30, 1e50] {
                let found = opening_mobility([length, 1.5 * length], 0.05 * length, detail).unwrap() * length;
                assert!((found / one - 1.0).abs() < 1e-12, "{detail:?} at {length:e}: {found}, not {one}");
            }
        }
    }

    #[test]
    fn the_less_is_known_the_more_they_give_way() {
        let at = |detail| opening_mobility([1.0, 1.5], 0.05, detail).unwrap();
        assert!(at(Detail::Exact) < at(Detail::Rigid) && at(Detail::Rigid) < at(Detail::Forces));
    }
}
