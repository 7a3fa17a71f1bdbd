//! Affine deformation by the background flow.

use domain::{Tensor, Vector};

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

    /// Matrix of the deformation.
    pub fn tensor(self) -> Tensor {
        match self {
            Self::Shear(strain) => {
                Tensor::IDENTITY + Tensor::from_cols_array_2d(&strain.to_array().map(|s| [s, 0.0, 0.0]))
            }
            Self::Stretch(factors) => Tensor::from_diagonal(factors),
        }
    }

    /// The deformed vector.
    pub fn of(self, vector: Vector) -> Vector {
        match self {
            Self::Shear(strain) => vector + Vector::X * strain.dot(vector),
            Self::Stretch(factors) => factors * vector,
        }
    }
}
