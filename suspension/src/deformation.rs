//! What a flow makes of what it carries along.

use domain::Vector;

/// What the flow makes of what it carries along.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Deformation {
    /// `x += s . r` of a vector `r`, where `s` is the strain along the gradient axis.
    Shear(Vector),
    /// Factors along the axes.
    Stretch(Vector),
}

impl Deformation {
    /// None.
    pub const NONE: Self = Self::Shear(Vector::ZERO);

    /// What becomes of a vector.
    pub fn of(self, vector: Vector) -> Vector {
        match self {
            Self::Shear(strain) => vector + Vector::X * strain.dot(vector),
            Self::Stretch(factors) => factors * vector,
        }
    }
}
