//! Rigid motions and the loads that go with them, one a particle.

use bytemuck::{Pod, Zeroable};
use domain::Vector;
use fcm::Linear;
use std::ops::{AddAssign, Neg};

/// Velocity and angular velocity of a particle, or the force and the torque on it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Screw(pub [f64; 6]);

impl Screw {
    /// From its two vectors.
    pub fn new(linear: Vector, angular: Vector) -> Self {
        Self([linear.x, linear.y, linear.z, angular.x, angular.y, angular.z])
    }

    /// Velocity, or force.
    pub fn linear(self) -> Vector {
        Vector::new(self.0[0], self.0[1], self.0[2])
    }

    /// Angular velocity, or torque.
    pub fn angular(self) -> Vector {
        Vector::new(self.0[3], self.0[4], self.0[5])
    }
}

impl AddAssign for Screw {
    fn add_assign(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(a, b)| *a += b);
    }
}

impl Neg for Screw {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

/// One for each particle that a rank owns.
#[derive(Debug, Clone, Default)]
pub struct Screws(pub Vec<Screw>);

impl Screws {
    /// From lists of vectors; an empty list stands for zeros.
    pub fn new(count: usize, linear: &[Vector], angular: &[Vector]) -> Self {
        let at = |list: &[Vector], i: usize| list.get(i).copied().unwrap_or_default();
        Self((0..count).map(|i| Screw::new(at(linear, i), at(angular, i))).collect())
    }

    /// The first vectors of all.
    pub fn linear(&self) -> Vec<Vector> {
        self.0.iter().map(|s| s.linear()).collect()
    }

    /// The second vectors of all.
    pub fn angular(&self) -> Vec<Vector> {
        self.0.iter().map(|s| s.angular()).collect()
    }
}

impl Screws {
    /// This rank's part of the inner product.
    pub fn dot(&self, other: &Self) -> f64 {
        let (a, b): (&[f64], &[f64]) = (bytemuck::cast_slice(&self.0), bytemuck::cast_slice(&other.0));
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }
}

impl Linear for Screws {
    fn add(&mut self, factor: f64, other: &Self) {
        let (a, b): (&mut [f64], &[f64]) = (bytemuck::cast_slice_mut(&mut self.0), bytemuck::cast_slice(&other.0));
        a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
    }
}
