//! Six-vectors: rigid-body motions of particles, or loads on them.

use bytemuck::{Pod, Zeroable};
use domain::Vector;
use domain::parallel::{FusedLoops, change, copied, mapped, of_rows};
use fcm::Linear;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Range, Sub};

/// Velocity and angular velocity of a particle, or the force and the torque on it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct SixVector(pub [f64; 6]);

impl SixVector {
    /// A six-vector from its two vectors.
    pub fn new(linear: Vector, angular: Vector) -> Self {
        Self([linear.x, linear.y, linear.z, angular.x, angular.y, angular.z])
    }

    /// The six-vector of a row of two lists, of which an empty one stands for zeros.
    pub fn of_row(row: usize, linear: &[Vector], angular: &[Vector]) -> Self {
        let at = |list: &[Vector]| list.get(row).copied().unwrap_or_default();
        Self::new(at(linear), at(angular))
    }

    /// This six-vector with its two vectors in other units.
    pub fn times(self, linear: f64, angular: f64) -> Self {
        Self::new(self.linear() * linear, self.angular() * angular)
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

impl AddAssign for SixVector {
    fn add_assign(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(a, b)| *a += b);
    }
}

impl Add for SixVector {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl Sub for SixVector {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }
}

/// Component by component, such as a motion times single-sphere resistances.
impl Mul for SixVector {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] * other.0[k]))
    }
}

impl Div for SixVector {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] / other.0[k]))
    }
}

impl Neg for SixVector {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

/// One six-vector for each particle of a rank.
#[derive(Debug, Default)]
pub struct SixVectors(pub Vec<SixVector>);

impl Clone for SixVectors {
    fn clone(&self) -> Self {
        Self(copied(&self.0))
    }
}

impl SixVectors {
    /// Six-vectors from lists of vectors; an empty list stands for zeros.
    pub fn new(count: usize, linear: &[Vector], angular: &[Vector]) -> Self {
        Self(of_rows(count, |row| SixVector::of_row(row, linear, angular)))
    }

    /// Velocities, or forces.
    pub fn linear(&self) -> Vec<Vector> {
        mapped(&self.0, |vector| vector.linear())
    }

    /// Angular velocities, or torques.
    pub fn angular(&self) -> Vec<Vector> {
        mapped(&self.0, |vector| vector.angular())
    }
}

impl SixVectors {
    /// `count` zero six-vectors.
    pub fn zero(count: usize) -> Self {
        Self(of_rows(count, |_| SixVector::default()))
    }

    /// This rank's part of the inner product.
    pub fn dot(&self, other: &Self) -> f64 {
        let (mut product, mut loops) = (0.0, FusedLoops::default());
        self.dot_in(&mut loops, other, &mut product);
        loops.run();
        product
    }

    /// [`Self::dot`] as one of several loops.
    pub fn dot_in<'a>(&'a self, loops: &mut FusedLoops<'a>, other: &'a Self, product: &'a mut f64) {
        loops.sum(product, self.0.len(), |rows: Range<usize>| dot(&self.0[rows.clone()], &other.0[rows]));
    }

    /// The negative of all six-vectors.
    pub fn negative(&self) -> Self {
        Self(mapped(&self.0, |&vector| -vector))
    }

    /// Loads of single spheres with the given resistances in these motions.
    pub fn resisted(&self, single: &[SixVector]) -> Self {
        Self(of_rows(self.0.len(), |row| single[row] * self.0[row]))
    }

    /// Their components, one after the other.
    pub fn components(&self) -> &[f64] {
        bytemuck::cast_slice(&self.0)
    }

    /// Their components, to be changed.
    pub fn components_mut(&mut self) -> &mut [f64] {
        bytemuck::cast_slice_mut(&mut self.0)
    }
}

/// Inner product.
#[inline(always)]
pub fn dot(vectors: &[SixVector], others: &[SixVector]) -> f64 {
    let mut sums = [0.0; 6];
    for (a, b) in vectors.iter().zip(others) {
        (0..6).for_each(|k| sums[k] += a.0[k] * b.0[k]);
    }
    sums.iter().sum()
}

impl Linear for SixVectors {
    fn add(&mut self, factor: f64, other: &Self) {
        change(self.components_mut(), other.components(), |a, b| *a += factor * b);
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        change(self.components_mut(), other.components(), |a, b| *a = b + factor * *a);
    }
}
