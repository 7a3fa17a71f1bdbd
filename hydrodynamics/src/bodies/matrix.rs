//! Matrices of single bodies.

use crate::six_vector::SixVector;
use bytemuck::{Pod, Zeroable};
use domain::{Tensor, Vector};
use std::ops::AddAssign;

/// A 6x6 matrix, column by column: resistance of a body, its inverse, or a product of such.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct BodyMatrix(pub [[f64; 6]; 6]);

/// Resistance of a sphere to motions of a sphere, by its blocks: those of the force and of the torque, due to the
/// velocity and to the angular velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereResistance {
    pub force: [Tensor; 2],
    pub torque: [Tensor; 2],
}

impl BodyMatrix {
    /// Number of components.
    pub const NUMBERS: usize = 36;

    /// Product with a vector.
    pub fn times(&self, vector: &SixVector) -> SixVector {
        let mut product = SixVector::default();
        for (column, factor) in self.0.iter().zip(vector.0) {
            (0..6).for_each(|i| product.0[i] += column[i] * factor);
        }
        product
    }

    /// The matrix with the rows and columns of some components replaced by those of `diagonal` times the identity.
    #[must_use]
    pub fn without(&self, components: [bool; 6], diagonal: f64) -> Self {
        let unit = |i: usize, k: usize| if i == k { diagonal } else { 0.0 };
        let component = |k: usize, i: usize| if components[i] || components[k] { unit(i, k) } else { self.0[k][i] };
        Self(std::array::from_fn(|k| std::array::from_fn(|i| component(k, i))))
    }

    /// Product with another matrix.
    #[must_use]
    pub fn product(&self, other: &Self) -> Self {
        Self(other.0.map(|column| self.times(&SixVector(column)).0))
    }

    /// `K_i^T A K_j`, with `A` the resistance of a sphere `i` to motions of a sphere `j` of the same body, and the arms
    /// of both.
    pub fn of_members(arms: [Vector; 2], blocks: &SphereResistance) -> Self {
        let SphereResistance { force, torque } = blocks;
        let turned = force[1] - times_cross(&force[0], arms[1]);
        let [moment, moment_turned] = [force[0], turned].map(|forces| cross(arms[0], &forces));
        let velocity = [force[0], torque[0] + moment];
        let rotation = [turned, torque[1] - times_cross(&torque[0], arms[1]) + moment_turned];
        let column = |[force, torque]: &[Tensor; 2], k: usize| SixVector::new(force.col(k), torque.col(k)).0;
        Self(std::array::from_fn(|k| if k < 3 { column(&velocity, k) } else { column(&rotation, k - 3) }))
    }
}

impl SphereResistance {
    /// Resistance of a single sphere to its own motion.
    pub fn of_single(single: &SixVector) -> Self {
        let [force, torque] = [single.linear(), single.angular()].map(Tensor::from_diagonal);
        Self { force: [force, Tensor::ZERO], torque: [Tensor::ZERO, torque] }
    }
}

/// The matrix with the products `v x c` of a vector and the columns `c` of a matrix.
fn cross(vector: Vector, matrix: &Tensor) -> Tensor {
    Tensor::from_cols(vector.cross(matrix.x_axis), vector.cross(matrix.y_axis), vector.cross(matrix.z_axis))
}

/// A matrix times that of the products `v x`.
fn times_cross(matrix: &Tensor, v: Vector) -> Tensor {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    Tensor::from_cols(y * v.z - z * v.y, z * v.x - x * v.z, x * v.y - y * v.x)
}

/// The matrix of the products `v x`.
pub fn cross_matrix(v: Vector) -> Tensor {
    times_cross(&Tensor::IDENTITY, v)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn tensor(first: f64) -> Tensor {
        Tensor::from_cols_array(&std::array::from_fn(|k| (first + 1.7 * k as f64).sin()))
    }

    /// The columns are the loads on the body in its unit motions, and products are those of the loads.
    #[test]
    fn matrices_of_members_give_the_loads_on_their_body() {
        let blocks = SphereResistance { force: [tensor(0.3), tensor(1.0)], torque: [tensor(2.0), tensor(-0.4)] };
        let arms = [Vector::new(0.3, -1.2, 0.7), Vector::new(-2.0, 0.4, 1.1)];
        let motion = SixVector([0.2, -0.5, 1.0, 0.9, 0.1, -0.6]);
        let of_sphere = motion_of_member(motion, arms[1]);
        let load = |[by_velocity, by_rotation]: [Tensor; 2]| {
            by_velocity * of_sphere.linear() + by_rotation * of_sphere.angular()
        };
        let expected = load_on_body(SixVector::new(load(blocks.force), load(blocks.torque)), arms[0]);
        let matrix = BodyMatrix::of_members(arms, &blocks);
        let found = matrix.times(&motion);
        assert!((0..6).all(|k| (found.0[k] - expected.0[k]).abs() < 1e-14), "{found:?}, {expected:?}");
        let [twice, in_turn] = [matrix.product(&matrix).times(&motion), matrix.times(&found)];
        assert!((0..6).all(|k| (twice.0[k] - in_turn.0[k]).abs() < 1e-13), "{twice:?}, {in_turn:?}");
    }
}
