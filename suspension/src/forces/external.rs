//! Steady forces and torques of the species, weight, and its torque on bottom-heavy spheres.

use super::acting::Configuration;
use super::force::Force;
use crate::model::{Model, Species};
use crate::rotation;
use domain::parallel::{change, mapped, of_rows};
use domain::{Particles, Vector, sphere};
use fcm::Loads;

/// Steady forces and torques of the species, their weight, and its torque on bottom-heavy spheres: the rate at which
/// they reorient (`Swimming::gyrotactic_time`) times the rotational drag, times `p x k` with the axis `p` and `k`
/// against gravity.
pub struct ExternalForces {
    species: Vec<Species>,
    gravity: Vector,
    viscosity: f64,
}

impl Force for ExternalForces {
    fn name(&self) -> &'static str {
        "external"
    }

    fn add_present_loads(&self, at: &Configuration, loads: &mut Loads) {
        self.add_steady_loads(at.particles, loads);
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
        Self { species: model.species.clone(), gravity: model.gravity, viscosity: model.viscosity }
    }

    /// Adds the loads on particles, which are steady as long as orientations are.
    pub fn add_steady_loads(&self, particles: &Particles, loads: &mut Loads) {
        add(&mut loads.forces, self.forces(particles));
        add(&mut loads.torques, self.torques(particles));
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
        let is_gyrotactic = self.species.iter().any(|s| s.reorientation_rate().is_some());
        if is_gyrotactic {
            return self.torques_on_axes(particles);
        }
        if self.species.iter().all(|s| s.torque == Vector::ZERO) {
            return Vec::new();
        }
        mapped(&particles.species, |&s| self.species[s as usize].torque)
    }

    /// Steady torques plus those of gravity on bottom-heavy spheres.
    fn torques_on_axes(&self, particles: &Particles) -> Vec<Vector> {
        let (orientations, up) = (rotation::known(particles), -self.gravity.normalize_or_zero());
        let torque = |row: usize| {
            let species = &self.species[particles.species[row] as usize];
            let drag = sphere::rotational_drag(self.viscosity, particles.radii[row]);
            let gyrotactic = |rate: f64| drag * rate * orientations[row].axis().cross(up);
            species.torque + species.reorientation_rate().map_or(Vector::ZERO, gyrotactic)
        };
        of_rows(particles.len(), torque)
    }
}
