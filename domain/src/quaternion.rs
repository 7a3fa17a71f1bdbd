//! Unit quaternions: rotations and orientations.

use crate::{AxisRotation, Random, Tensor, Vector};
use bytemuck::{Pod, Zeroable};
use std::ops::Mul;

/// A rotation by an angle about an axis as the quaternion `(cos(angle/2), sin(angle/2) axis)`, the scalar part first.
/// The product of two rotations is the rotation by the right one followed by that of the left one.
///
/// As an orientation it is the rotation from axes fixed in the body to those of space. The body's axis of symmetry, if
/// it has one, is its third, so that an unrotated body points along z: [`Self::axis`].
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Quaternion {
    /// Scalar part.
    pub w: f64,
    /// Vector part.
    pub v: Vector,
}

/// Squared angle below which sine and cosine of half of it are Taylor series, with errors below round-off.
const SMALL: f64 = 1e-4;

impl Quaternion {
    /// No rotation.
    pub const IDENTITY: Self = Self { w: 1.0, v: Vector::ZERO };

    /// The value for bodies without orientation, which no rotation changes.
    pub const NONE: Self = Self { w: 0.0, v: Vector::ZERO };

    /// From its components `w, x, y, z`.
    pub const fn from_array([w, x, y, z]: [f64; 4]) -> Self {
        Self { w, v: Vector::new(x, y, z) }
    }

    /// Components `w, x, y, z`.
    pub const fn to_array(self) -> [f64; 4] {
        [self.w, self.v.x, self.v.y, self.v.z]
    }

    /// The exponential map (Rodrigues): rotation about a vector by an angle of its length.
    pub fn exp(rotation: Vector) -> Self {
        let square = rotation.length_squared();
        if square < SMALL {
            let half = 0.5 - square / 48.0 + square * square / 3840.0;
            return Self { w: 1.0 - square / 8.0 + square * square / 384.0, v: rotation * half };
        }
        let angle = square.sqrt();
        let (sine, cosine) = (0.5 * angle).sin_cos();
        Self { w: cosine, v: rotation * (sine / angle) }
    }

    /// The vector of a rotation, the inverse of [`Self::exp`], of a length of at most pi.
    pub fn log(self) -> Vector {
        let sine = self.v.length();
        let (w, v) = if self.w < 0.0 { (-self.w, -self.v) } else { (self.w, self.v) };
        if sine < 1e-8 { 2.0 * v } else { v * (2.0 * sine.atan2(w) / sine) }
    }

    /// A rotation that takes the direction of one vector to that of another, along the shorter way. For opposite
    /// directions it is half a turn about some axis across them.
    pub fn between(from: Vector, to: Vector) -> Self {
        let (from, to) = (from.normalize(), to.normalize());
        if from.dot(to) > 0.0 {
            let middle = (from + to).normalize();
            return Self { w: from.dot(middle), v: from.cross(middle) };
        }
        // Near opposite directions the axis is across `from` to the last digit, though its direction is not known well.
        let across = from.cross(to);
        let axis = if across.length() < 1e-15 { from.any_orthonormal_vector() } else { across.reject_from(from) };
        Self { w: 0.5 * (from + to).length(), v: axis.normalize() * (0.5 * (to - from).length()) }
    }

    /// The rotation of a matrix, which has to be one.
    pub fn of_matrix(matrix: &Tensor) -> Self {
        let q = glam::DQuat::from_mat3(matrix);
        Self { w: q.w, v: Vector::new(q.x, q.y, q.z) }
    }

    /// A random rotation, all being equally likely (Shoemake, Graphics Gems III, 1992): a point on the unit sphere of
    /// four dimensions.
    pub fn random(random: &mut Random) -> Self {
        let [fraction, first, second] = random.point().to_array();
        let [first, second] = [first, second].map(|turn| std::f64::consts::TAU * turn);
        let (inner, outer) = ((1.0 - fraction).sqrt(), fraction.sqrt());
        Self { w: outer * second.cos(), v: Vector::new(inner * first.sin(), inner * first.cos(), outer * second.sin()) }
    }

    /// Inverse rotation.
    #[must_use]
    pub fn inverse(self) -> Self {
        Self { w: self.w, v: -self.v }
    }

    /// Length; 1 for rotations.
    pub fn length(self) -> f64 {
        (self.w * self.w + self.v.length_squared()).sqrt()
    }

    /// The same rotation without round-off in its length; unchanged without orientation.
    #[must_use]
    pub fn normalized(self) -> Self {
        let length = self.length();
        if length > 0.0 { Self { w: self.w / length, v: self.v / length } } else { self }
    }

    /// Whether there is an orientation.
    pub fn is_some(self) -> bool {
        self != Self::NONE
    }

    /// The rotated vector.
    pub fn rotate(self, vector: Vector) -> Vector {
        let twice = 2.0 * self.v.cross(vector);
        vector + self.w * twice + self.v.cross(twice)
    }

    /// The axis of a body of this orientation, which is along z without rotation.
    pub fn axis(self) -> Vector {
        let Self { w, v: Vector { x, y, z } } = self;
        Vector::new(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w + z * z - x * x - y * y)
    }
}

impl Mul for Quaternion {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            w: self.w * other.w - self.v.dot(other.v),
            v: self.w * other.v + other.w * self.v + self.v.cross(other.v),
        }
    }
}

impl AxisRotation {
    /// The orientation of a body in the rotated axes.
    pub fn quaternion(self, orientation: Quaternion) -> Quaternion {
        if self.is_none() {
            return orientation;
        }
        let matrix = Tensor::from_cols(self.vector(Vector::X), self.vector(Vector::Y), self.vector(Vector::Z));
        Quaternion::of_matrix(&matrix) * orientation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Vector = Vector::new(0.3, -1.1, 0.7);
    const B: Vector = Vector::new(-0.5, 0.2, 1.9);

    fn is_near(a: Vector, b: Vector) -> bool {
        (a - b).length() < 1e-14
    }

    /// Rodrigues' formula, written out; quaternions of small angles included.
    #[test]
    fn the_exponential_map_rotates_about_its_vector() {
        for angle in [1e-9, 1e-3, 0.00999, 0.01001, 0.5, 3.0, 10.0] {
            let axis = A.normalize();
            let (sine, cosine) = f64::sin_cos(angle);
            let expected = B * cosine + axis.cross(B) * sine + axis * (axis.dot(B) * (1.0 - cosine));
            let q = Quaternion::exp(axis * angle);
            assert!(is_near(q.rotate(B), expected) && (q.length() - 1.0).abs() < 1e-15, "{angle}");
            if angle < 3.1 {
                assert!((q.log() - axis * angle).length() < 1e-14 * angle.max(1.0), "{angle}");
            }
        }
    }

    #[test]
    fn a_product_is_one_rotation_after_the_other() {
        let (first, second) = (Quaternion::exp(A), Quaternion::exp(B));
        assert!(is_near((second * first).rotate(A + B), second.rotate(first.rotate(A + B))));
        assert!(is_near((first.inverse() * first).rotate(B), B));
        assert!(is_near(first.axis(), first.rotate(Vector::Z)));
        let matrix = Tensor::from_cols(first.rotate(Vector::X), first.rotate(Vector::Y), first.rotate(Vector::Z));
        assert!(is_near(Quaternion::of_matrix(&matrix).rotate(B), first.rotate(B)));
        assert_eq!(Quaternion::from_array(second.to_array()), second);
        assert_eq!(first * Quaternion::NONE, Quaternion::NONE);
        assert!(!Quaternion::NONE.normalized().is_some() && first.is_some());
    }

    #[test]
    fn a_direction_is_taken_to_another() {
        for to in [A, -3.0 * B, Vector::Z, -Vector::Z, Vector::new(1e-9, 0.0, -1.0)] {
            let q = Quaternion::between(2.0 * Vector::Z, to);
            assert!((q.axis() - to.normalize()).length() < 1e-14 && (q.length() - 1.0).abs() < 1e-14, "{to}");
        }
    }

    /// Means and second moments of the rotated axes, within five standard errors of `n` samples.
    #[test]
    fn random_rotations_are_isotropic() {
        let count = 100_000;
        let (mut mean, mut squares, mut angles) = (Vector::ZERO, Vector::ZERO, 0.0);
        for name in 0..count {
            let q = Quaternion::random(&mut Random::new(3, name));
            assert!((q.length() - 1.0).abs() < 1e-15);
            let turned = q.rotate(Vector::X);
            mean += turned / count as f64;
            squares += turned * turned / count as f64;
            angles += q.log().length() / count as f64;
        }
        let error = 1.0 / (count as f64).sqrt();
        assert!(mean.abs().max_element() < 5.0 * error / 3.0_f64.sqrt(), "{mean}");
        assert!((squares - 1.0 / 3.0).abs().max_element() < 5.0 * error * (4.0_f64 / 45.0).sqrt(), "{squares}");
        // Angles have the density (1 - cos angle) / pi from 0 to pi, of mean pi/2 + 2/pi and variance below 0.42.
        let expected = 0.5 * std::f64::consts::PI + 2.0 / std::f64::consts::PI;
        assert!((angles - expected).abs() < 5.0 * 0.65 * error, "{angles}");
    }

    #[test]
    fn axes_and_bodies_turn_together() {
        for axis in 0..3 {
            let (turn, body) = (AxisRotation::to_last(axis), Quaternion::exp(A));
            assert!(is_near(turn.quaternion(body).rotate(B), turn.vector(body.rotate(B))));
            assert!(is_near(turn.inverse().quaternion(turn.quaternion(body)).rotate(B), body.rotate(B)));
        }
    }
}
