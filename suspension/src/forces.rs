//! What acts on the particles besides the fluid.

use crate::model::{Model, Repulsion, Species};
use crate::near::Near;
use domain::{Particles, Partition, PeriodicBox, Tensor, Vector};
use fcm::Loads;
use lubrication::{Barrier, BarrierError};

/// Steady forces and torques by species, weight, and the repulsion barrier.
pub struct Forces {
    species: Vec<Species>,
    gravity: Vector,
    barrier: Option<(Barrier, f64)>,
}

/// The repulsion of a scene, if it has one.
pub fn barrier(model: &Model) -> Result<Option<Barrier>, BarrierError> {
    let lubricated = model.hydrodynamics.lubrication;
    let range = if lubricated { Barrier::RANGE_WITH_LUBRICATION } else { Barrier::RANGE_ALONE };
    let barrier = |r: Repulsion| Ok(Barrier::new(r.strength, r.range.unwrap_or(range))?.growing(r.radius_power));
    model.repulsion.map(barrier).transpose()
}

impl Forces {
    /// The forces of a scene whose largest particle has the given radius.
    pub fn new(model: &Model, largest_radius: f64) -> Result<Self, BarrierError> {
        let with_reach = |barrier: Barrier| (barrier, barrier.reach([largest_radius; 2]));
        let barrier = barrier(model)?.map(with_reach);
        Ok(Self { species: model.species.clone(), gravity: model.gravity, barrier })
    }

    /// Forces and torques on the particles that this rank owns. Collective.
    pub fn on(&self, particles: &Particles, cell: &PeriodicBox, partition: &Partition) -> Loads {
        let mut forces = self.steady_forces(particles);
        if let Some((barrier, reach)) = &self.barrier {
            forces.resize(particles.len(), Vector::ZERO);
            let repulsion = Near::find(particles, cell, partition, *reach).sums(|separation, radii| {
                let force = barrier.force(separation, radii);
                [force, -force]
            });
            forces.iter_mut().zip(repulsion).for_each(|(force, repulsion)| *force += repulsion);
        }
        Loads { forces, torques: self.torques(particles), stresslets: Vec::new() }
    }

    /// For each particle that this rank owns, its share of the first moments of repulsion: of a pair at `x_i` and
    /// `x_j`, where the first feels the force `F`, each has `-(x_i - x_j) F / 2`. Without repulsion there are none.
    /// Collective.
    pub fn repulsion_moments(&self, particles: &Particles, cell: &PeriodicBox, partition: &Partition) -> Vec<Tensor> {
        let Some((barrier, reach)) = &self.barrier else { return Vec::new() };
        Near::find(particles, cell, partition, *reach).sums(|separation, radii| {
            let force = barrier.force(separation, radii);
            let half = Tensor::from_cols(separation * force.x, separation * force.y, separation * force.z) * 0.5;
            [half, half]
        })
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
