//! What acts on the particles besides the fluid.

use super::near::Near;
use domain::{Particles, Partition, PeriodicBox, Vector};
use fcm::Loads;
use io::{Species, SuspensionScene};
use lubrication::{Barrier, BarrierError};

/// Steady forces and torques by species, weight, and the repulsion barrier.
pub struct Forces {
    species: Vec<Species>,
    gravity: Vector,
    barrier: Option<(Barrier, f64)>,
}

impl Forces {
    /// The forces of a scene whose largest particle has the given radius.
    pub fn new(scene: &SuspensionScene, largest_radius: f64) -> Result<Self, BarrierError> {
        let lubricated = scene.hydrodynamics.lubrication;
        let range = if lubricated { Barrier::RANGE_WITH_LUBRICATION } else { Barrier::RANGE_ALONE };
        let barrier = scene.repulsion.map(|r| Barrier::new(r.strength, r.range.unwrap_or(range)));
        let with_reach = |barrier: Barrier| (barrier, barrier.reach([largest_radius; 2]));
        let barrier = barrier.transpose()?.map(with_reach);
        Ok(Self { species: scene.species.clone(), gravity: scene.gravity, barrier })
    }

    /// Forces and torques on the particles that this rank owns. Collective.
    pub fn on(&self, particles: &Particles, cell: &PeriodicBox, partition: &Partition) -> Loads {
        let mut forces = self.steady_forces(particles);
        if let Some((barrier, reach)) = &self.barrier {
            forces.resize(particles.len(), Vector::ZERO);
            let near = Near::find(particles, cell, partition, *reach);
            near.add_forces(&mut forces, |separation, radii| barrier.force(separation, radii));
        }
        Loads { forces, torques: self.torques(particles), stresslets: Vec::new() }
    }

    fn steady_forces(&self, particles: &Particles) -> Vec<Vector> {
        if self.species.iter().all(|s| s.force_on(1.0, self.gravity) == Vector::ZERO) {
            return Vec::new();
        }
        let force = |(&species, &radius): (&u32, &f64)| self.species[species as usize].force_on(radius, self.gravity);
        particles.species.iter().zip(&particles.radii).map(force).collect()
    }

    fn torques(&self, particles: &Particles) -> Vec<Vector> {
        if self.species.iter().all(|s| s.torque == Vector::ZERO) {
            return Vec::new();
        }
        particles.species.iter().map(|&s| self.species[s as usize].torque).collect()
    }
}
