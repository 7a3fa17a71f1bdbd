//! Steady forces and torques of the species, and weight.

use super::acting::Configuration;
use super::force::Force;
use crate::model::{Model, Species};
use domain::parallel::{change, mapped, of_rows};
use domain::{Particles, Vector};
use fcm::Loads;

/// Steady forces and torques of the species, and their weight.
pub struct ExternalForces {
    species: Vec<Species>,
    gravity: Vector,
}

impl Force for ExternalForces {
    fn name(&self) -> &'static str {
        "external"
    }

    fn add_present_loads(&self, at: &Configuration, loads: &mut Loads) {
        add(&mut loads.forces, self.forces(at.particles));
        add(&mut loads.torques, self.torques(at.particles));
    }
}

/// Adds a load to each particle; an empty list stands for none.
fn add(loads: &mut Vec<Vector>, more: Vec<Vector>) {
    if loads.is_empty() {
        *loads = more;
    } else {
        change(loads, &more, |load, &more| *load += more);
    }
}

impl ExternalForces {
    /// The forces of a model.
    pub fn of(model: &Model) -> Self {
        Self { species: model.species.clone(), gravity: model.gravity }
    }

    /// Sums over this rank's particles of the x and y components of forces, and of the first moments along z of the x
    /// and y components of forces, torques included.
    pub fn sums_along_walls(&self, particles: &Particles) -> [f64; 4] {
        let (forces, torques) = (self.forces(particles), self.torques(particles));
        let at = |list: &[Vector], row: usize| list.get(row).copied().unwrap_or_default();
        let mut sums = [0.0; 4];
        for (row, place) in particles.positions.iter().enumerate() {
            let (f, t) = (at(&forces, row), at(&torques, row));
            let own = [f.x, f.y, place.z * f.x + 0.5 * t.y, place.z * f.y - 0.5 * t.x];
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        sums
    }

    fn forces(&self, particles: &Particles) -> Vec<Vector> {
        if self.species.iter().all(|s| s.force_on(1.0, self.gravity) == Vector::ZERO) {
            return Vec::new();
        }
        let force =
            |row: usize| self.species[particles.species[row] as usize].force_on(particles.radii[row], self.gravity);
        of_rows(particles.len(), force)
    }

    fn torques(&self, particles: &Particles) -> Vec<Vector> {
        if self.species.iter().all(|s| s.torque == Vector::ZERO) {
            return Vec::new();
        }
        mapped(&particles.species, |&s| self.species[s as usize].torque)
    }
}
