//! Matrices of single bodies.

use crate::six_vector::SixVector;
use bytemuck::{Pod, Zeroable};
use domain::Vector;
use std::ops::AddAssign;

/// A 6x6 matrix: resistance of a body, its inverse, or a product of such.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct BodyMatrix(pub [[f64; 6]; 6]);

impl BodyMatrix {
    /// Number of components.
    pub const NUMBERS: usize = 36;

    /// Product with a vector.
    pub fn times(&self, vector: &SixVector) -> SixVector {
        let row = |i: usize| (0..6).map(|k| self.0[i][k] * vector.0[k]).sum();
        SixVector(std::array::from_fn(row))
    }

    /// The matrix with the rows and columns of some components replaced by those of `diagonal` times the identity.
    #[must_use]
    pub fn without(&self, components: [bool; 6], diagonal: f64) -> Self {
        let unit = |i: usize, k: usize| if i == k { diagonal } else { 0.0 };
        let component = |i: usize, k: usize| if components[i] || components[k] { unit(i, k) } else { self.0[i][k] };
        Self(std::array::from_fn(|i| std::array::from_fn(|k| component(i, k))))
    }

    /// Product with another matrix.
    #[must_use]
    pub fn product(&self, other: &Self) -> Self {
        let component = |i: usize, k: usize| (0..6).map(|j| self.0[i][j] * other.0[j][k]).sum();
        Self(std::array::from_fn(|i| std::array::from_fn(|k| component(i, k))))
    }

    /// `K_i^T A K_j`, with `A` the loads on a sphere `i` due to motions of a sphere `j` of the same body, and the arms
    /// of both.
    pub fn of_members(arms: [Vector; 2], loads: impl Fn(SixVector) -> SixVector) -> Self {
        let mut columns = [[0.0; 6]; 6];
        for (k, column) in columns.iter_mut().enumerate() {
            let mut unit = SixVector::default();
            unit.0[k] = 1.0;
            *column = load_on_body(loads(motion_of_member(unit, arms[1])), arms[0]).0;
        }
        Self(std::array::from_fn(|i| columns.map(|column| column[i])))
    }
}

impl AddAssign for BodyMatrix {
    fn add_assign(&mut self, other: Self) {
        self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened()).for_each(|(sum, value)| *sum += value);
    }
}

/// Motion of a member, from that of its body and its arm.
pub fn motion_of_member(body: SixVector, arm: Vector) -> SixVector {
    SixVector::new(body.linear() + body.angular().cross(arm), body.angular())
}

/// Load on a body, from that on a member with an arm.
pub fn load_on_body(load: SixVector, arm: Vector) -> SixVector {
    SixVector::new(load.linear(), load.angular() + arm.cross(load.linear()))
}
