//! What acts on the particles besides the fluid.

use crate::model::{Model, Repulsion, Species};
use crate::near::Near;
use domain::{Particles, Partition, PeriodicBox, Tensor, Traceless, Vector};
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

/// How particles will move for some time, by which forces at its end are foretold.
pub struct Ahead<'a> {
    /// The time.
    pub time: f64,
    /// Velocities relative to the background flow, as expected.
    pub velocities: &'a [Vector],
    /// What they have of a flow besides.
    pub strain_rate: Traceless,
}

impl Forces {
    /// The forces of a scene whose largest particle has the given radius.
    pub fn new(model: &Model, largest_radius: f64) -> Result<Self, BarrierError> {
        let with_reach = |barrier: Barrier| (barrier, barrier.reach([largest_radius; 2]));
        let barrier = barrier(model)?.map(with_reach);
        Ok(Self { species: model.species.clone(), gravity: model.gravity, barrier })
    }

    /// Forces and torques on the particles that this rank owns. Where they are to be those at the end of some time, repulsion
    /// has what [`Self::resistance`] takes off it for the velocities expected: so the sum of both is right for these, and
    /// nearly for others. Collective.
    pub fn on(
        &self,
        particles: &Particles,
        (cell, partition): (&PeriodicBox, &Partition),
        ahead: Option<&Ahead>,
    ) -> Loads {
        let mut forces = self.steady_forces(particles);
        if let Some((barrier, reach)) = &self.barrier {
            forces.resize(particles.len(), Vector::ZERO);
            let near = Near::find(particles, cell, partition, *reach);
            let added = ahead.map(|ahead| self.expected(&near, ahead)).unwrap_or_default();
            let on_pair = |(k, (separation, radii, _)): (usize, (Vector, [f64; 2], _))| {
                let force = barrier.force(separation, radii) + added.get(k).copied().unwrap_or_default();
                [force, -force]
            };
            let repulsion = near.summed(near.pairs().enumerate().map(on_pair));
            forces.iter_mut().zip(repulsion).for_each(|(force, repulsion)| *force += repulsion);
        }
        Loads { forces, torques: self.torques(particles), stresslets: Vec::new() }
    }

    /// For each pair, the force on the first sphere by which [`Self::resistance`] changes repulsion at the velocities
    /// expected, taken back. Collective.
    fn expected(&self, near: &Near, ahead: &Ahead) -> Vec<Vector> {
        let (relative, strain_rate) = (near.differences(ahead.velocities), ahead.strain_rate.tensor());
        let of_pair = |((separation, radii, _), velocity): ((Vector, [f64; 2], _), Vector)| {
            let distance = separation.length();
            let axis = separation / distance;
            axis * (-self.resistance(ahead.time, distance, radii) * axis.dot(velocity + strain_rate * separation))
        };
        near.pairs().zip(relative).map(of_pair).collect()
    }

    /// By how much the repulsion of two spheres at a distance falls in some time if they part at unit velocity.
    pub fn resistance(&self, time: f64, distance: f64, radii: [f64; 2]) -> f64 {
        let gap = distance - radii[0] - radii[1];
        self.barrier.as_ref().map_or(0.0, |(barrier, _)| time * barrier.stiffness(gap, radii))
    }

    /// The gap over the mean radius up to which spheres repel each other; 0 if they do not.
    pub fn range(&self) -> f64 {
        self.barrier.as_ref().map_or(0.0, |(barrier, _)| barrier.range())
    }

    /// The distance of centres up to which spheres repel each other, if they do.
    pub fn reach(&self) -> Option<f64> {
        self.barrier.as_ref().map(|(_, reach)| *reach)
    }

    /// For each particle that this rank owns, its share of the first moments of repulsion: of a pair at `x_i` and
    /// `x_j`, where the first feels the force `F`, each has `-(x_i - x_j) F / 2`. Without repulsion there are none. Where it
    /// is to be that at the end of some time, forces change by [`Self::resistance`] to velocities beyond those expected.
    /// Collective.
    pub fn repulsion_moments(
        &self,
        particles: &Particles,
        (cell, partition): (&PeriodicBox, &Partition),
        beyond: Option<&Ahead>,
    ) -> Vec<Tensor> {
        let Some((barrier, reach)) = &self.barrier else { return Vec::new() };
        let near = Near::find(particles, cell, partition, *reach);
        let taken_back = beyond.map(|ahead| self.expected(&near, ahead)).unwrap_or_default();
        let of_pair = |(k, (separation, radii, _)): (usize, (Vector, [f64; 2], _))| {
            let force = barrier.force(separation, radii) - taken_back.get(k).copied().unwrap_or_default();
            let half = Tensor::from_cols(separation * force.x, separation * force.y, separation * force.z) * 0.5;
            [half, half]
        };
        near.summed(near.pairs().enumerate().map(of_pair))
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
