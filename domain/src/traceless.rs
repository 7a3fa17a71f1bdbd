//! Symmetric traceless tensors: stresslets and rates of strain.

use crate::{Tensor, Vector};
use bytemuck::{Pod, Zeroable};
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A symmetric traceless 3 x 3 tensor by its five components xx, xy, xz, yy, yz; zz = -(xx + yy).
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Traceless(pub [f64; 5]);

impl Traceless {
    /// The zero tensor.
    pub const ZERO: Self = Self([0.0; 5]);

    /// The symmetric traceless part of any tensor: `(A + A^T)/2 - tr(A)/3 I`.
    pub fn part_of(tensor: &Tensor) -> Self {
        let third = (tensor.x_axis.x + tensor.y_axis.y + tensor.z_axis.z) / 3.0;
        Self([
            tensor.x_axis.x - third,
            0.5 * (tensor.x_axis.y + tensor.y_axis.x),
            0.5 * (tensor.x_axis.z + tensor.z_axis.x),
            tensor.y_axis.y - third,
            0.5 * (tensor.y_axis.z + tensor.z_axis.y),
        ])
    }

    /// Tensor with all nine components.
    pub fn tensor(self) -> Tensor {
        let [xx, xy, xz, yy, yz] = self.0;
        Tensor::from_cols(Vector::new(xx, xy, xz), Vector::new(xy, yy, yz), Vector::new(xz, yz, -xx - yy))
    }

    /// Double contraction `A : B = A_ij B_ij`.
    pub fn contract(self, other: Self) -> f64 {
        let ([a, b, c, d, e], [p, q, r, s, t]) = (self.0, other.0);
        a * p + d * s + (a + d) * (p + s) + 2.0 * (b * q + c * r + e * t)
    }
}

impl Add for Traceless {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Sub for Traceless {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] - other.0[i]))
    }
}

impl Neg for Traceless {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Mul<f64> for Traceless {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|c| c * factor))
    }
}

impl AddAssign for Traceless {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contraction_is_that_of_all_nine_components() {
        let a = Traceless([1.0, 2.0, -3.0, 0.5, 4.0]);
        let b = Traceless([-0.3, 1.5, 2.5, 0.7, -1.1]);
        let (s, t) = (a.tensor(), b.tensor());
        let all_nine: f64 = (0..3).flat_map(|j| (0..3).map(move |i| s.col(j)[i] * t.col(j)[i])).sum();
        assert!((a.contract(b) - all_nine).abs() < 1e-14 * all_nine.abs());
    }

    #[test]
    fn components_add_and_subtract() {
        let (a, b) = (Traceless([1.0, 2.0, -3.0, 0.5, 4.0]), Traceless([0.5, -2.0, 1.0, 0.25, 8.0]));
        assert_eq!(a + b, Traceless([1.5, 0.0, -2.0, 0.75, 12.0]));
        assert_eq!((a + b) - b, a);
        assert_eq!(a + -a, Traceless::default());
    }

    #[test]
    fn part_of_a_tensor_drops_trace_and_rotation() {
        let a = Traceless([1.0, 2.0, -3.0, 0.5, 4.0]);
        let rotation = Tensor::from_cols_array(&[0.0, 1.0, 2.0, -1.0, 0.0, 3.0, -2.0, -3.0, 0.0]);
        assert_eq!(Traceless::part_of(&(a.tensor() + rotation + Tensor::IDENTITY * 2.0)), a);
    }
}
