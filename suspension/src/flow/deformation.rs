//! Affine deformation by the background flow.

use domain::Vector;

/// Affine deformation of vectors by the background flow over a strain increment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Deformation {
    /// `r += (s . r) e_x` for a vector `r`, where `s` is the strain along the gradient axis.
    Shear(Vector),
    /// Stretch ratios along the axes.
    Stretch(Vector),
}

impl Deformation {
    /// No deformation.
    pub const NONE: Self = Self::Shear(Vector::ZERO);

    /// The deformed vector.
    pub fn of(self, vector: Vector) -> Vector {
        match self {
            Self::Shear(strain) => vector + Vector::X * strain.dot(vector),
            Self::Stretch(factors) => factors * vector,
        }
    }
}
