//! Rigid bodies made of spheres.

pub mod matrix;
pub mod present;
mod shared;

use crate::six_vector::{SixVector, SixVectors};
use domain::parallel::{MeasuredLoop, SortedRows, change_rows, concat, copied, mapped, of_rows, sort};
use domain::{Comm, Vector};
use fcm::{Loads, Motion};
use matrix::{BodyMatrix, load_on_body, motion_of_member};
use rayon::prelude::*;
use shared::SharedBodies;
use std::ops::AddAssign;

/// Membership of a rank's spheres in rigid bodies. The spheres of a body with the velocity `V` and the angular velocity
/// `Omega` move as `U = V + Omega x s` and `Omega`, with `s` the arm of the sphere. For all bodies this is `K Q`; the
/// loads of spheres add up to the loads `K^T L` of their bodies.
#[derive(Clone)]
pub struct RigidBodies {
    /// Numbers of the bodies with spheres on this rank, in ascending order.
    numbers: Vec<u32>,
    /// Place of the body of each row in `numbers`; its length for free spheres.
    places: Vec<u32>,
    /// Rows of each body, and of the free spheres.
    members: SortedRows,
    /// Positions of the spheres minus those of the centres of their bodies, row by row.
    arms: Vec<Vector>,
    shared: SharedBodies,
}

/// Number of bodies whose members one thread sums at a time, at least.
const BATCH: usize = 64;

/// Number of spheres whose bodies one thread collects at a time.
const TILE: usize = 4096;

impl RigidBodies {
    /// Bodies of a rank's spheres. `bodies[row]` is the number of the sphere's body, `None` for a free one, and
    /// `arms[row]` its position minus that of the centre of its body (any point of the body), in the frame of the box.
    /// Spheres of a body may be on several ranks. Collective.
    ///
    /// # Panics
    ///
    /// If the lists have different lengths.
    pub fn new(comm: &Comm, bodies: &[Option<u32>], arms: &[Vector]) -> Self {
        assert_eq!(bodies.len(), arms.len(), "each sphere has an arm");
        let of_tile = |tile: &[Option<u32>]| tile.iter().copied().flatten().collect();
        let mut numbers = concat(bodies.par_chunks(TILE).map(of_tile).measured().collect());
        sort(numbers.len(), || numbers.par_sort_unstable());
        numbers.dedup();
        let free = numbers.len() as u32;
        let place = |body: &Option<u32>| body.map_or(free, |body| numbers.partition_point(|&n| n < body) as u32);
        let places = mapped(bodies, place);
        let members = SortedRows::by_key(&places, numbers.len() + 1);
        let shared = SharedBodies::new(comm, &numbers);
        Self { places, members, arms: copied(arms), shared, numbers }
    }

    /// Numbers of the bodies with spheres on this rank, in ascending order. Other lists of bodies have this order.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// Number of the body of the sphere in a row; `None` for a free sphere.
    pub fn body(&self, row: usize) -> Option<u32> {
        self.numbers.get(self.places[row] as usize).copied()
    }

    /// Place of the body of the sphere in a row in lists of bodies; `None` for a free sphere.
    pub fn place(&self, row: usize) -> Option<usize> {
        let place = self.places[row] as usize;
        (place < self.numbers.len()).then_some(place)
    }

    /// Arm of the sphere in a row.
    pub fn arm(&self, row: usize) -> Vector {
        self.arms[row]
    }

    /// Forces and torques on the bodies: sums of the loads on their spheres. Empty lists stand for zeros. Collective.
    pub fn total_loads(&self, loads: &Loads) -> Loads {
        let totals = self.totals(&SixVectors::new(self.places.len(), &loads.forces, &loads.torques));
        Loads { forces: totals.linear(), torques: totals.angular(), stresslets: Vec::new() }
    }

    /// Velocities of the centres and angular velocities of the bodies, from motions of the spheres as parts of rigid
    /// bodies. The same on all ranks. Collective.
    pub fn body_motions(&self, motion: &Motion) -> Motion {
        let at = |list: &[Vector], row: usize| list.get(row).copied().unwrap_or_default();
        let of_member = |row: usize| {
            let angular = at(&motion.angular_velocities, row);
            motion_of_member(SixVector::new(at(&motion.velocities, row), angular), -self.arms[row])
        };
        let mean = self.means(of_member);
        Motion { velocities: mean.linear(), angular_velocities: mean.angular(), strain_rates: Vec::new() }
    }

    /// Motions of the spheres as parts of bodies with the given motions; zero for free spheres.
    pub fn sphere_motions(&self, bodies: &Motion) -> Motion {
        let bodies = SixVectors::new(self.numbers.len(), &bodies.velocities, &bodies.angular_velocities);
        let member = |row: usize| self.motion(row, &bodies).unwrap_or_default();
        let motions = SixVectors(of_rows(self.places.len(), member));
        Motion { velocities: motions.linear(), angular_velocities: motions.angular(), strain_rates: Vec::new() }
    }
}

impl RigidBodies {
    /// These bodies with arms in another unit.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self { arms: mapped(&self.arms, |&arm| arm * factor), ..self.clone() }
    }

    /// `K Q` in a row: motion of the sphere as a part of its body; `None` for a free sphere.
    pub(crate) fn motion(&self, row: usize, bodies: &SixVectors) -> Option<SixVector> {
        let of_body = bodies.0.get(self.places[row] as usize)?;
        Some(motion_of_member(*of_body, self.arms[row]))
    }

    /// `K^T L`: loads on the bodies. Collective.
    pub(crate) fn totals(&self, loads: &SixVectors) -> SixVectors {
        let mut totals = SixVectors(self.sums(|row| load_on_body(loads.0[row], self.arms[row])));
        self.shared.sum(bytemuck::cast_slice_mut(&mut totals.0), 6);
        totals
    }

    /// Row of the first sphere of a body on this rank.
    pub(crate) fn first_member(&self, body: usize) -> usize {
        self.members.of(body)[0] as usize
    }

    /// Sums of a matrix of each sphere over the members of the bodies. Collective.
    pub(crate) fn matrices(&self, of_sphere: impl Fn(usize) -> BodyMatrix + Sync) -> Vec<BodyMatrix> {
        let mut sums = self.sums(of_sphere);
        self.shared.sum(bytemuck::cast_slice_mut(&mut sums), BodyMatrix::NUMBERS);
        sums
    }

    /// Sets values of free spheres to zero.
    pub(crate) fn keep_members(&self, values: &mut SixVectors) {
        change_rows(&mut values.0, |row, value| {
            if self.body(row).is_none() {
                *value = SixVector::default();
            }
        });
    }

    /// Means over the members of the bodies. Collective.
    fn means(&self, of_member: impl Fn(usize) -> SixVector + Sync) -> SixVectors {
        let sums = self.sums(of_member);
        let mut counted: Vec<[f64; 7]> = (0..self.numbers.len())
            .map(|body| {
                let count = self.members.of(body).len() as f64;
                std::array::from_fn(|k| sums[body].0.get(k).copied().unwrap_or(count))
            })
            .collect();
        self.shared.sum(bytemuck::cast_slice_mut(&mut counted), 7);
        SixVectors(mapped(&counted, |sum| SixVector(std::array::from_fn(|k| sum[k] / sum[6]))))
    }

    /// Sums over this rank's members of the bodies, in the order of the rows.
    fn sums<T: Default + AddAssign + Send>(&self, of_member: impl Fn(usize) -> T + Sync) -> Vec<T> {
        let of_body = |body: usize| {
            let mut sum = T::default();
            self.members.of(body).iter().for_each(|&row| sum += of_member(row as usize));
            sum
        };
        (0..self.numbers.len()).into_par_iter().with_min_len(BATCH).map(of_body).measured().collect()
    }
}

#[cfg(test)]
mod tests;
