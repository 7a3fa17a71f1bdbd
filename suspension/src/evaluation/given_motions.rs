//! Given motions of bodies in a solve.

use super::Dynamics;
use crate::bodies;
use crate::model::{Bodies, Model};
use domain::Particles;
use hydrodynamics::{GivenMotion, RigidBodies, Solution};

/// Given motions of the bodies of a model, in the frame of the box.
#[derive(Default)]
pub struct GivenMotions {
    /// For each kind of bodies the number after that of its last body, and the motion; empty if none is given.
    of_kinds: Vec<(u64, GivenMotion)>,
}

impl GivenMotions {
    /// The motions of a model.
    pub fn of(model: &Model) -> Self {
        let mut end = 0;
        let of_kind = |kind: &Bodies| {
            end += kind.count;
            (end, kind.motion)
        };
        let of_kinds: Vec<_> = model.bodies.iter().map(of_kind).collect();
        Self { of_kinds: if of_kinds.iter().all(|(_, motion)| motion.is_none()) { Vec::new() } else { of_kinds } }
    }

    /// The motion of the body of a number.
    fn of_body(&self, number: u32) -> Option<GivenMotion> {
        let of_its_kind = self.of_kinds.iter().find(|(end, _)| u64::from(number) < *end);
        of_its_kind.map(|(_, motion)| *motion).filter(|motion| !motion.is_none())
    }
}

impl Dynamics {
    /// The bodies of a rank's particles, with the given motions relative to the background flow at their centres;
    /// `None` without bodies. Collective.
    pub(super) fn bodies(&self, particles: &mut Particles) -> Option<RigidBodies> {
        let all = bodies::of(particles, self.partition.comm())?;
        if self.given_motions.of_kinds.is_empty() {
            return Some(all);
        }
        let members = all.members();
        let of_body = |(place, &number): (usize, &u32)| {
            let (given, row) = (self.given_motions.of_body(number)?, members.rows(place)[0] as usize);
            let centre = particles.positions[row] - members.arm(row);
            let flow = self.moving.velocity_of(centre, 0.0);
            Some(given.relative_to(flow, self.moving.angular_velocity_at(centre)))
        };
        let given = all.numbers().iter().enumerate().map(of_body).collect();
        Some(all.with_given_motions(given))
    }

    /// Stores velocities of the centres of bodies, their stress, and the loads that given motions take, of a solution.
    pub(super) fn record_bodies(&self, particles: &mut Particles, solved: &Solution) {
        bodies::record(particles, &solved.constraint_loads.forces, self.moving.advecting_gradient());
        if !self.given_motions.of_kinds.is_empty() {
            bodies::store_loads(particles, &solved.constraint_loads);
        }
    }
}
