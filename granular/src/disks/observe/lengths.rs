//! Viscous length and mean free path, whose ratio decides whether disks segregate.

use crate::disks::DiskModel;
use std::f64::consts::{FRAC_PI_4, PI};

/// Viscous length `zeta = mu (1 + r_b / r_s) rate / (6 pi viscosity)` of eq. (A6): the distance by which a
/// collision with the largest disk throws the smallest one through the liquid, `mu` their reduced mass.
/// Infinite without viscosity.
pub fn viscous_length(model: &DiskModel) -> f64 {
    let (small, big) = (model.smallest(), model.largest());
    let reduced = 1.0 / (1.0 / model.mass(small) + 1.0 / model.mass(big));
    let rate = model.parameters().flow.rate(model.parameters().edges[1]).abs();
    reduced * (1.0 + big / small) * rate / (6.0 * PI * model.parameters().viscosity)
}

/// Mean free path across lanes of disks of radius 1 at an area fraction `c`, as estimated in appendix B: with
/// `x = pi / (4 c) - 1`, half the gap in radii between two disks of a lane, `l = x` where a disk rarely passes a lane,
/// (B3), and `l = -1 / ln(1 - p)`, `p = 1 / x`, (B5), where that is longer. Zero above the densest lanes, `c = pi/4`.
pub fn estimated_free_path(area_fraction: f64) -> f64 {
    let gap = (FRAC_PI_4 / area_fraction - 1.0).max(0.0);
    let passing = if gap > 1.0 { -1.0 / (1.0 - 1.0 / gap).ln() } else { 0.0 };
    gap.min(1.0).max(passing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disks::{DiskParameters, LengthUnit};

    #[test]
    fn viscous_lengths_are_those_of_the_table() {
        // Both mass exponents and length units; the third row gives the lengths that the paper quotes.
        let table = [
            (LengthUnit::Mean, 2, [1.91, 0.478, 0.191, 0.064]),
            (LengthUnit::Mean, 3, [1.75, 0.437, 0.175, 0.058]),
            (LengthUnit::Smallest, 2, [2.497, 0.624, 0.2497, 0.0832]),
            (LengthUnit::Smallest, 3, [2.61, 0.653, 0.261, 0.087]),
        ];
        for (length_unit, mass_exponent, lengths) in table {
            for (viscosity, expected) in [0.001, 0.004, 0.01, 0.03].into_iter().zip(lengths) {
                let parameters = DiskParameters { length_unit, mass_exponent, viscosity, ..DiskParameters::default() };
                let zeta = viscous_length(&DiskModel::new(parameters).unwrap());
                assert!((zeta / expected - 1.0).abs() < 8e-3, "{zeta} for {expected}");
            }
        }
    }

    #[test]
    fn free_paths_follow_appendix_b() {
        assert!((estimated_free_path(0.6) - (FRAC_PI_4 / 0.6 - 1.0)).abs() < 1e-15);
        assert!((estimated_free_path(0.01) / (FRAC_PI_4 / 0.01) - 1.0).abs() < 0.03, "dilute: both forms agree");
        assert!(estimated_free_path(0.8) == 0.0);
    }
}
