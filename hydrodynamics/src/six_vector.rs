//! Six-vectors: rigid-body motions of particles, or loads on them.

use bytemuck::{Pod, Zeroable};
use domain::Vector;
use domain::parallel::{MeasuredLoop, copied, mapped, of_rows};
use fcm::Linear;
use rayon::prelude::*;
use std::ops::{AddAssign, Neg};

/// Velocity and angular velocity of a particle, or the force and the torque on it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct SixVector(pub [f64; 6]);

impl SixVector {
    /// A six-vector from its two vectors.
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

impl AddAssign for SixVector {
    fn add_assign(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(a, b)| *a += b);
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
        let at = |list: &[Vector], i: usize| list.get(i).copied().unwrap_or_default();
        let vector = |i: usize| SixVector::new(at(linear, i), at(angular, i));
        Self(of_rows(count, vector))
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

/// Number of six-vectors that one thread processes at a time; the sums of these batches are added in their order.
const BATCH: usize = 1024;

impl SixVectors {
    /// `count` zero six-vectors.
    pub fn zero(count: usize) -> Self {
        Self(of_rows(count, |_| SixVector::default()))
    }

    /// Bytes of a number of lists of this length.
    fn bytes(&self, lists: usize) -> usize {
        lists * size_of_val(&self.0[..])
    }

    /// This rank's part of the inner product.
    pub fn dot(&self, other: &Self) -> f64 {
        let products = self.0.par_chunks(BATCH).zip(other.0.par_chunks(BATCH)).map(|(a, b)| dot(a, b));
        let sums: Vec<f64> = products.moving(self.bytes(2)).collect();
        sums.iter().sum()
    }

    /// The negative of all six-vectors.
    pub fn negative(&self) -> Self {
        Self(self.0.par_iter().with_min_len(BATCH).map(|&vector| -vector).moving(self.bytes(2)).collect())
    }

    /// Loads of single spheres with the given resistances in these motions.
    pub fn resisted(&self, single: &[SixVector]) -> Self {
        let resist =
            |(motion, single): (&SixVector, &SixVector)| SixVector(std::array::from_fn(|k| single.0[k] * motion.0[k]));
        Self(self.0.par_iter().with_min_len(BATCH).zip(single).map(resist).moving(self.bytes(3)).collect())
    }

    /// Adds `factor` times the loads of single spheres with the given resistances in motions.
    pub fn add_resisted(&mut self, factor: f64, single: &[SixVector], motions: &Self) {
        let add = |((load, single), motion): ((&mut SixVector, &SixVector), &SixVector)| {
            (0..6).for_each(|k| load.0[k] += factor * single.0[k] * motion.0[k]);
        };
        let bytes = self.bytes(4);
        self.0.par_iter_mut().with_min_len(BATCH).zip(single).zip(&motions.0).moving(bytes).for_each(add);
    }
}

impl SixVectors {
    /// These motions minus those of single spheres with the given resistances under loads.
    pub fn minus_single_sphere_motions(&self, single: &[SixVector], loads: &Self) -> Self {
        let less = |((motion, single), load): ((&SixVector, &SixVector), &SixVector)| {
            SixVector(std::array::from_fn(|k| motion.0[k] - load.0[k] / single.0[k]))
        };
        Self(self.0.par_iter().with_min_len(BATCH).zip(single).zip(&loads.0).map(less).moving(self.bytes(4)).collect())
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
        self.changed(other, |a, b| *a += factor * b);
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        self.changed(other, |a, b| *a = b + factor * *a);
    }
}

impl SixVectors {
    fn changed(&mut self, other: &Self, change: impl Fn(&mut f64, f64) + Sync) {
        let bytes = self.bytes(3);
        self.0.par_chunks_mut(BATCH).zip(other.0.par_chunks(BATCH)).moving(bytes).for_each(|(a, b)| {
            let (a, b): (&mut [f64], &[f64]) = (bytemuck::cast_slice_mut(a), bytemuck::cast_slice(b));
            a.iter_mut().zip(b).for_each(|(a, b)| change(a, *b));
        });
    }
}
