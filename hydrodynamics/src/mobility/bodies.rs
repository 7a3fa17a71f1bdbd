//! Rigid bodies of a mobility's spheres.

use super::columns::fill;
use crate::bodies::RigidBodies;
use domain::{Comm, Particles, Vector};
use fcm::Motion;

/// Bodies to which spheres belong, and where they are placed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BodySpheres {
    /// Number of the body of each sphere; empty without bodies.
    of: Vec<Option<u32>>,
    /// Number of bodies.
    count: usize,
    /// Positions of the spheres minus the mean of those of their body.
    arms: Vec<Vector>,
}

/// Names of the columns with the body, its number plus one, the arm, and the motion of the body.
const BODY: &str = "body";
const ARM: &str = "arm";
const VELOCITY: &str = "body velocity";
const ANGULAR_VELOCITY: &str = "body angular velocity";

impl BodySpheres {
    /// Bodies of spheres with these numbers, `None` for free spheres.
    pub fn new(of: Vec<Option<u32>>) -> Self {
        let count = of.iter().flatten().max().map_or(0, |&last| last as usize + 1);
        Self { of: if count == 0 { Vec::new() } else { of }, count, arms: Vec::new() }
    }

    /// Whether there are any bodies.
    pub fn is_any(&self) -> bool {
        self.count > 0
    }

    /// Whether two spheres are parts of one body.
    pub fn are_of_one(&self, [first, second]: [u32; 2]) -> bool {
        let of = |sphere: u32| self.of.get(sphere as usize).copied().flatten();
        of(first).is_some() && of(first) == of(second)
    }

    /// Places the spheres at positions that are not wrapped into a box.
    pub fn place(&mut self, positions: &[Vector]) {
        let mut sums = vec![(Vector::ZERO, 0.0); self.count];
        for (&position, &body) in positions.iter().zip(&self.of) {
            if let Some(body) = body {
                let (sum, count) = &mut sums[body as usize];
                *sum += position;
                *count += 1.0;
            }
        }
        let arm = |(&position, &body): (&Vector, &Option<u32>)| {
            body.map_or(Vector::ZERO, |body| position - sums[body as usize].0 / sums[body as usize].1)
        };
        self.arms = positions.iter().zip(&self.of).map(arm).collect();
    }

    /// Writes the bodies and the arms into columns of the particles, which are in the order of the spheres.
    pub fn store(&self, particles: &mut Particles) {
        if self.is_any() {
            let number = |body: &Option<u32>| body.map_or(0.0, |body| f64::from(body) + 1.0);
            let numbers: Vec<f64> = self.of.iter().map(number).collect();
            fill(&mut particles.column(BODY, 1).values, &numbers);
            fill(particles.vectors(ARM), &self.arms);
        }
    }

    /// The bodies of a rank's particles, from their columns; `None` without bodies. Collective.
    pub fn load(&self, particles: &mut Particles, comm: &Comm) -> Option<RigidBodies> {
        self.is_any().then(|| {
            let number = |&value: &f64| (value > 0.0).then(|| value as u32 - 1);
            let bodies: Vec<Option<u32>> = particles.column(BODY, 1).values.iter().map(number).collect();
            RigidBodies::new(comm, &bodies, particles.vectors(ARM))
        })
    }

    /// The motions of the bodies from columns of all particles in the order of the spheres.
    pub fn motions(&self, all: &mut Particles) -> Motion {
        let mut of_bodies = |name: &str| {
            let mut found = vec![Vector::ZERO; self.count];
            for (&value, body) in all.vectors(name).iter().zip(&self.of) {
                if let Some(body) = *body {
                    found[body as usize] = value;
                }
            }
            found
        };
        let [velocities, angular_velocities] = [VELOCITY, ANGULAR_VELOCITY].map(&mut of_bodies);
        Motion { velocities, angular_velocities, strain_rates: Vec::new() }
    }
}

/// Writes the motions of the bodies into columns of their members.
pub fn record_bodies(particles: &mut Particles, bodies: &RigidBodies, motions: &Motion) {
    let rows = 0..particles.len();
    for (name, list) in [(VELOCITY, &motions.velocities), (ANGULAR_VELOCITY, &motions.angular_velocities)] {
        let of_row = |row: usize| bodies.members().place(row).map_or(Vector::ZERO, |place| list[place]);
        let values: Vec<Vector> = rows.clone().map(of_row).collect();
        fill(particles.vectors(name), &values);
    }
}
