//! Two polarisable spheres in a uniform field: exact moments, and those of dipoles.

mod dipoles;
mod exact;
mod near_contact;
#[cfg(test)]
mod tests;

pub use dipoles::dipole_moments;
pub use exact::exact_moments;
pub use near_contact::{PairPolarisation, PolarisedPairTable};

/// Two spheres of magnetisable or dielectric material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolarisablePair {
    /// Radii.
    pub radii: [f64; 2],
    /// Susceptibilities, the ratio of the permeabilities or permittivities of sphere and fluid minus 1: above -1.
    pub susceptibilities: [f64; 2],
}

/// Moments of the two spheres of a pair over the applied field, a volume each: in a field along the line of centres and
/// in one across it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PairMoments {
    /// In a field along the line of centres.
    pub along: [f64; 2],
    /// In a field across it.
    pub across: [f64; 2],
}

impl PairMoments {
    /// Minus the moments of another state.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        Self {
            along: [0, 1].map(|i| self.along[i] - other.along[i]),
            across: [0, 1].map(|i| self.across[i] - other.across[i]),
        }
    }
}
