//! Rigid bodies made of spheres.

mod given_motion;
pub mod matrix;
pub mod members;
pub mod present;
mod shared;

use crate::six_vector::{SixVector, SixVectors};
use domain::parallel::{mapped, of_rows};
use domain::{Comm, Units, Vector};
use fcm::{Loads, Motion};
pub use given_motion::GivenMotion;
use matrix::{BodyMatrix, motion_of_member};
use members::Members;
use shared::SharedBodies;

/// Membership of a rank's spheres in rigid bodies. The spheres of a body with the velocity `V` and the angular velocity
/// `Omega` move as `U = V + Omega x s` and `Omega`, with `s` the arm of the sphere. For all bodies this is `K Q`; the
/// loads of spheres add up to the loads `K^T L` of their bodies.
#[derive(Clone)]
pub struct RigidBodies {
    members: Members,
    shared: SharedBodies,
    /// Given components of the motions of bodies; empty if no body has any.
    given: Vec<Option<GivenMotion>>,
}

impl RigidBodies {
    /// Bodies of a rank's spheres. `bodies[row]` is the number of the sphere's body, `None` for a free one, and
    /// `arms[row]` its position minus that of the centre of its body (any point of the body), in the frame of the box.
    /// Spheres of a body may be on several ranks. Collective.
    ///
    /// # Panics
    ///
    /// If the lists have different lengths.
    pub fn new(comm: &Comm, bodies: &[Option<u32>], arms: &[Vector]) -> Self {
        let members = Members::new(bodies, arms);
        Self { shared: SharedBodies::new(comm, members.numbers()), members, given: Vec::new() }
    }

    /// These bodies with components of their motions given, in the order of [`Self::numbers`]. The constraint loads of
    /// a solution then have the total force and torque that this motion takes in addition to the given loads.
    ///
    /// # Panics
    ///
    /// If the list has another length.
    #[must_use]
    pub fn with_given_motions(self, given: Vec<Option<GivenMotion>>) -> Self {
        assert_eq!(given.len(), self.numbers().len(), "a motion for each body");
        Self { given, ..self }
    }

    /// Numbers of the bodies with spheres on this rank, in ascending order. Other lists of bodies have this order.
    pub fn numbers(&self) -> &[u32] {
        self.members.numbers()
    }

    /// The spheres of the bodies on this rank.
    pub fn members(&self) -> &Members {
        &self.members
    }

    /// Number of the body of the sphere in a row; `None` for a free sphere.
    pub fn body(&self, row: usize) -> Option<u32> {
        self.members.body(row)
    }

    /// Forces and torques on the bodies: sums of the loads on their spheres. Empty lists stand for zeros. Collective.
    pub fn total_loads(&self, loads: &Loads) -> Loads {
        let totals = self.totals(&SixVectors::new(self.members.spheres(), &loads.forces, &loads.torques));
        Loads { forces: totals.linear(), torques: totals.angular(), stresslets: Vec::new() }
    }

    /// Velocities of the centres and angular velocities of the bodies, from motions of the spheres as parts of rigid
    /// bodies. The same on all ranks. Collective.
    pub fn body_motions(&self, motion: &Motion) -> Motion {
        let members = &self.members;
        let at = |list: &[Vector], row: usize| list.get(row).copied().unwrap_or_default();
        let of_member = |row: usize| {
            let angular = at(&motion.angular_velocities, row);
            motion_of_member(SixVector::new(at(&motion.velocities, row), angular), -members.arm(row))
        };
        let mean = self.means(of_member);
        Motion { velocities: mean.linear(), angular_velocities: mean.angular(), strain_rates: Vec::new() }
    }

    /// Motions of the spheres as parts of bodies with the given motions; zero for free spheres.
    pub fn sphere_motions(&self, bodies: &Motion) -> Motion {
        let members = &self.members;
        let bodies = SixVectors::new(members.numbers().len(), &bodies.velocities, &bodies.angular_velocities);
        let member = |row: usize| members.motion(row, &bodies).unwrap_or_default();
        let motions = SixVectors(of_rows(members.spheres(), member));
        Motion { velocities: motions.linear(), angular_velocities: motions.angular(), strain_rates: Vec::new() }
    }
}

/// Given components.
impl RigidBodies {
    /// Motions of the bodies with the given components in place of those that are found.
    pub fn with_given(&self, mut bodies: Motion) -> Motion {
        for place in 0..self.given.len() {
            let GivenMotion { velocity, angular_velocity } = self.given_motion(place);
            for axis in 0..3 {
                bodies.velocities[place][axis] = velocity[axis].unwrap_or(bodies.velocities[place][axis]);
                let turning = bodies.angular_velocities[place][axis];
                bodies.angular_velocities[place][axis] = angular_velocity[axis].unwrap_or(turning);
            }
        }
        bodies
    }

    /// Given components of the motion of a body, by its place.
    fn given_motion(&self, place: usize) -> GivenMotion {
        self.given.get(place).copied().flatten().unwrap_or_default()
    }

    /// A force and a torque on the body of a place, or its motion, with zeros along given components.
    pub fn free_part(&self, place: usize, [linear, angular]: [Vector; 2]) -> [Vector; 2] {
        let given = self.given_motion(place);
        let free = |known: [Option<f64>; 3], of: Vector| {
            Vector::from_array([0, 1, 2].map(|axis| if known[axis].is_some() { 0.0 } else { of[axis] }))
        };
        [free(given.velocity, linear), free(given.angular_velocity, angular)]
    }
}

impl RigidBodies {
    /// These bodies in scaled units.
    pub(crate) fn in_units(&self, units: &Units) -> Self {
        let given = mapped(&self.given, |given| given.map(|given| given.in_units(units)));
        Self { members: self.members.scaled(1.0 / units.length), shared: self.shared.clone(), given }
    }

    /// Given components of the motions of the bodies, by their places; empty if no body on this rank has any.
    pub(crate) fn given_components(&self) -> Vec<[Option<f64>; 6]> {
        mapped(&self.given, |given| given.unwrap_or_default().components())
    }

    /// `K^T L`: loads on the bodies. Collective.
    pub(crate) fn totals(&self, loads: &SixVectors) -> SixVectors {
        let mut totals = self.members.totals(loads);
        self.shared.sum(bytemuck::cast_slice_mut(&mut totals.0), 6);
        totals
    }

    /// Sums of six numbers of each sphere over the members of the bodies. Collective.
    pub(crate) fn sums_of(&self, of_sphere: impl Fn(usize) -> [f64; 6] + Sync) -> SixVectors {
        let mut sums = SixVectors(self.members.sums(|row| SixVector(of_sphere(row))));
        self.shared.sum(bytemuck::cast_slice_mut(&mut sums.0), 6);
        sums
    }

    /// Sums of a matrix of each sphere over the members of the bodies. Collective.
    pub(crate) fn matrices(&self, of_sphere: impl Fn(usize) -> BodyMatrix + Sync) -> Vec<BodyMatrix> {
        let mut sums = self.members.sums(of_sphere);
        self.shared.sum(bytemuck::cast_slice_mut(&mut sums), BodyMatrix::NUMBERS);
        sums
    }

    /// Means over the members of the bodies. Collective.
    fn means(&self, of_member: impl Fn(usize) -> SixVector + Sync) -> SixVectors {
        let sums = self.members.sums(of_member);
        let mut counted: Vec<[f64; 7]> = (0..sums.len())
            .map(|body| {
                let count = self.members.rows(body).len() as f64;
                std::array::from_fn(|k| sums[body].0.get(k).copied().unwrap_or(count))
            })
            .collect();
        self.shared.sum(bytemuck::cast_slice_mut(&mut counted), 7);
        SixVectors(mapped(&counted, |sum| SixVector(std::array::from_fn(|k| sum[k] / sum[6]))))
    }
}

#[cfg(test)]
mod tests;
