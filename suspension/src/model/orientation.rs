//! Orientations of the spheres of a species at the start.

use super::{MultipoleOrder, Parameters, Start};
use domain::{ParameterError, Vector};

/// Orientations of the spheres of a species at the start. An orientation is a rotation of the sphere's own axes, whose
/// third is the axis that order parameters and correlations are about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Orientation {
    /// All rotations are equally likely.
    Random,
    /// The axis of every sphere is along this vector, of any length.
    Aligned(Vector),
    /// Orientations provided by the caller together with positions.
    Given,
    /// The orientation of the rigid body to which the sphere belongs.
    OfBody,
}

impl Orientation {
    /// Refuses an axis without direction, spheres that do not rotate, and orientations that nobody provides.
    pub(super) fn check(&self, index: usize, p: &Parameters) -> Result<(), ParameterError> {
        let key = format!("species[{index}].orientation");
        if p.hydrodynamics.multipoles == MultipoleOrder::Monopole {
            let message = "is set, but spheres do not rotate with hydrodynamics.multipoles = \"monopole\"; take \
                \"dipole\", or leave it out";
            return Err(ParameterError::new(key, message));
        }
        match self {
            Self::Aligned(axis) => {
                let (key, axis) = (format!("{key}_axis"), p.user_axes().vector(*axis));
                ParameterError::require_finite_vector(&key, axis)?;
                if axis.normalize_or_zero() == Vector::ZERO {
                    return Err(ParameterError::new(
                        key,
                        "has no direction; one of its numbers needs to be other than 0",
                    ));
                }
                Ok(())
            }
            Self::Given if p.start != Start::Given => {
                let message =
                    "is \"file\", which goes with particles.initial = \"file\"; take \"random\" or \"aligned\"";
                Err(ParameterError::new(key, message))
            }
            Self::Random | Self::Given | Self::OfBody => Ok(()),
        }
    }
}

impl Parameters {
    /// Whether some species has orientations.
    pub fn has_orientations(&self) -> bool {
        self.species.iter().any(|species| species.orientation.is_some())
    }
}
