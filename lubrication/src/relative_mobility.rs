//! Relative mobility of a near pair along its line of centres.

use crate::dense::inverse;
use crate::far_field;
use crate::two_sphere::blocks::{ResistanceBlocks, part};
use crate::two_sphere::{TwoSphere, TwoSphereError};
use domain::power_of_two;

/// Model of the hydrodynamics of a near pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairModel {
    /// Monopoles alone: spheres need not be rigid.
    Forces,
    /// The force-coupling method with its stresslets.
    Rigid,
    /// The exact solution, as with lubrication.
    Exact,
}

/// Velocity at which two spheres in unbounded fluid separate under opposite unit forces along their line of centres,
/// times the viscosity: `x_11 + x_22 - 2 x_12` of the axial mobilities.
pub fn relative_axial_mobility(radii: [f64; 2], gap: f64, model: PairModel) -> Result<f64, TwoSphereError> {
    // In units of length in which the radii are about 1; a mobility times viscosity is an inverse length.
    let unit = power_of_two(radii[0].min(radii[1]));
    let (radii, gap) = (radii.map(|radius| radius / unit), gap / unit);
    let distance = radii[0] + radii[1] + gap;
    let mobility = match model {
        PairModel::Forces => far_field::axial_mobility(radii, distance),
        PairModel::Rigid => inverse(part(&far_field::resistance(radii, distance).axial, 0, 0)),
        PairModel::Exact => {
            let (small, large) = (radii[0].min(radii[1]), radii[0].max(radii[1]));
            let exact = TwoSphere::with_ratio(large / small)?.at(gap / small);
            inverse(part(&ResistanceBlocks::exact(&exact, [small, large]).axial, 0, 0))
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
        for model in [PairModel::Forces, PairModel::Rigid, PairModel::Exact] {
            for radii in [[1.0, 2.0], [2.0, 1.0]] {
                let found = relative_axial_mobility(radii, 1e4, model).unwrap();
                assert!((found / alone - 1.0).abs() < 1e-3, "{model:?}: {found}, alone {alone}");
            }
        }
    }

    #[test]
    fn exact_spheres_near_contact_give_way_in_proportion_to_the_gap() {
        // A force of 3/2 pi a^2 V / h for equal spheres that separate with the velocity V.
        let found = relative_axial_mobility([2.0; 2], 2e-5, PairModel::Exact).unwrap();
        assert!((found / (2e-5 / (1.5 * PI * 4.0)) - 1.0).abs() < 1e-3, "{found}");
    }

    #[test]
    fn in_other_units_of_length_they_give_way_alike() {
        for model in [PairModel::Forces, PairModel::Rigid, PairModel::Exact] {
            let one = relative_axial_mobility([1.0, 1.5], 0.05, model).unwrap();
            for length in [1e-50, 1e-30, 3e30, 1e50] {
                let found = relative_axial_mobility([length, 1.5 * length], 0.05 * length, model).unwrap() * length;
                assert!((found / one - 1.0).abs() < 1e-12, "{model:?} at {length:e}: {found}, not {one}");
            }
        }
    }

    #[test]
    fn the_less_is_known_the_more_they_give_way() {
        let at = |model| relative_axial_mobility([1.0, 1.5], 0.05, model).unwrap();
        assert!(at(PairModel::Exact) < at(PairModel::Rigid) && at(PairModel::Rigid) < at(PairModel::Forces));
    }
}
