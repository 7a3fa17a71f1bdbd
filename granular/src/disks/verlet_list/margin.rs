//! The skin of the Verlet list: the margin of its cutoff beyond contact.

/// A pair whose radii add up to `R` is listed if its distance is less than `R (1 + stretch) + skin`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ListMargin {
    skin: f64,
    stretch: f64,
    /// Smallest and largest sum of two radii.
    contact_distances: [f64; 2],
}

/// Skin in units of the smallest sum of radii; the fastest of those tried for the mixture of the paper.
const SKIN: f64 = 0.35;
/// Strain that the stretch allows for: that of a shear at the rate 0.01 before the skin is used up.
const STRAIN: f64 = 0.05;

impl ListMargin {
    pub(crate) fn new(smallest: f64, largest: f64) -> Self {
        let contact_distances = [2.0 * smallest, 2.0 * largest];
        Self { skin: SKIN * contact_distances[0], stretch: norm(STRAIN) - 1.0, contact_distances }
    }

    /// Distance below which a pair is listed.
    pub(crate) fn cutoff(&self, contact_distance: f64) -> f64 {
        contact_distance * (1.0 + self.stretch) + self.skin
    }

    /// Whether a pair that was not listed may be in contact now. Two disks in contact, `|d| < R`, were at
    /// `d_0 = S^-1 (d - e)` with a shear `S` of at most `strain` and `|e| <= 2 drift`, so that
    /// `|d_0| < |S^-1| (R + 2 drift)`. The list is used up when that can exceed the cutoff; both are linear in `R`.
    pub(crate) fn is_used_up(&self, strain: f64, drift: f64) -> bool {
        self.contact_distances
            .iter()
            .any(|contact_distance| norm(strain) * (contact_distance + 2.0 * drift) > self.cutoff(*contact_distance))
    }
}

/// The largest factor by which a shear stretches a vector.
fn norm(strain: f64) -> f64 {
    0.5 * strain + (1.0 + 0.25 * strain * strain).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat2, DVec2};

    #[test]
    fn the_norm_is_that_of_the_matrix() {
        for strain in [0.0, 0.03, 0.5] {
            let shear = DMat2::from_cols(DVec2::X, DVec2::new(strain, 1.0));
            let stretched = |k: u32| (shear * DVec2::from_angle(f64::from(k) * 1e-4)).length();
            let largest = (0..31416).map(stretched).fold(0.0, f64::max);
            // The largest of samples 1e-4 apart, near a flat maximum.
            assert!((norm(strain) - largest).abs() < 1e-8);
        }
    }

    #[test]
    fn drift_and_strain_use_it_up() {
        let margin = ListMargin::new(1.0, 4.0);
        assert!(!margin.is_used_up(0.0, 0.5 * SKIN * 2.0));
        assert!(margin.is_used_up(0.0, 1.1 * SKIN * 2.0));
        assert!(margin.is_used_up(0.5, 0.0));
    }
}
