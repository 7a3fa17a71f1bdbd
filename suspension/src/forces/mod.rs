//! Non-hydrodynamic forces on the particles.

pub mod contacts;
pub mod tethers;
pub mod user;

use crate::model::{Attraction, Model, Repulsion, Species};
use crate::neighbourhood::{Near, NearLists};
use domain::{Particles, Partition, PeriodicBox, Tensor, ToWall, Traceless, Vector};
use fcm::Loads;
use lubrication::{Barrier, BarrierError, PairKind, SurfaceForce};
use std::ops::AddAssign;

/// Steady forces and torques of the species, weight, repulsion and attraction.
pub struct Forces {
    species: Vec<Species>,
    gravity: Vector,
    surface: SurfaceForces,
    /// Neighbour lists for forces between spheres, if there are such forces.
    near: Option<NearLists>,
    /// Gap over the mean radius up to which spheres repel each other; 0 without repulsion.
    range: f64,
}

/// Repulsion and attraction.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceForces {
    /// Repulsion, if there is any.
    pub repulsion: Option<SurfaceForce>,
    /// Attraction, if there is any.
    pub attraction: Option<SurfaceForce>,
}

/// Kind of surface force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// Repulsion.
    Repulsion,
    /// Attraction.
    Attraction,
}

impl SurfaceForces {
    /// Surface forces of a model.
    pub fn of(model: &Model) -> Result<Self, BarrierError> {
        let usual =
            if model.hydrodynamics.lubrication { Barrier::RANGE_WITH_LUBRICATION } else { Barrier::RANGE_ALONE };
        let repulsion = |r: Repulsion| match r.screening_length {
            None => {
                let barrier = Barrier::new(r.strength, r.range.unwrap_or(usual))?;
                Ok(SurfaceForce::Barrier(barrier.growing(r.radius_power)))
            }
            Some(length) => Ok(SurfaceForce::Screened { strength: r.strength, radius_power: r.radius_power, length }),
        };
        Ok(Self {
            repulsion: model.repulsion.map(repulsion).transpose()?,
            attraction: model.attraction.map(Attraction::force),
        })
    }

    fn all(&self) -> impl Iterator<Item = &SurfaceForce> {
        self.repulsion.iter().chain(&self.attraction)
    }

    /// Centre distance up to which forces act between spheres of two radii; `None` without forces.
    pub fn reach(&self, radii: [f64; 2]) -> Option<f64> {
        self.all().map(|force| force.reach(radii)).reduce(f64::max)
    }

    /// Decrease of the repulsion of two spheres, or of a sphere and a wall, over a time in which they separate with
    /// unit velocity.
    pub fn resistance(&self, time: f64, distance: f64, between: impl Into<PairKind>) -> f64 {
        let between = between.into();
        let gap = match between {
            PairKind::Spheres(radii) => distance - radii[0] - radii[1],
            PairKind::Wall(radius) => distance - radius,
        };
        self.repulsion.map_or(0.0, |repulsion| time * repulsion.stiffness(gap, between))
    }

    fn force(&self, separation: Vector, between: impl Into<PairKind>) -> Vector {
        let between = between.into();
        self.all().map(|force| force.force(separation, between)).reduce(|sum, force| sum + force).unwrap_or_default()
    }
}

/// Predicted motion of the particles over a time, for forces at its end.
pub struct Prediction<'a> {
    /// Length of time.
    pub time: f64,
    /// Predicted velocities relative to the background flow.
    pub velocities: &'a [Vector],
    /// Strain rate of a linear flow that these velocities include.
    pub strain_rate: Traceless,
}

impl Forces {
    /// The forces of a model whose largest particle has the given radius.
    pub fn new(model: &Model, largest_radius: f64, partition: &Partition) -> Result<Self, BarrierError> {
        let surface = SurfaceForces::of(model)?;
        let near = surface.reach([largest_radius; 2]).map(|reach| NearLists::new(reach, partition));
        let smallest = model.species.iter().map(|s| s.radius).fold(f64::INFINITY, f64::min);
        let range = match surface.repulsion {
            Some(SurfaceForce::Barrier(barrier)) => barrier.range(),
            Some(SurfaceForce::Screened { length, .. }) => length / smallest,
            _ => 0.0,
        };
        Ok(Self { species: model.species.clone(), gravity: model.gravity, surface, near, range })
    }

    /// Continues with another partition of space.
    pub fn divide(&mut self, partition: &Partition) {
        self.near.iter_mut().for_each(|near| near.divide(partition));
    }

    /// Forces and torques on this rank's particles. With a prediction, the decrease of the repulsion by
    /// [`SurfaceForces::resistance`] at the predicted velocities is added back, so that repulsion minus resistance
    /// times velocity is exact at the predicted velocities and approximate at others. Collective.
    pub fn on(
        &self,
        particles: &Particles,
        (cell, partition): (&PeriodicBox, &Partition),
        ahead: Option<&Prediction>,
    ) -> Loads {
        let mut forces = self.steady_forces(particles);
        if let Some(near) = &self.near {
            forces.resize(particles.len(), Vector::ZERO);
            let near = near.find(particles, (cell, partition));
            let added = ahead.map(|ahead| self.expected(&near, ahead)).unwrap_or_default();
            let on_pair = |(k, (separation, radii, _)): (usize, (Vector, [f64; 2], _))| {
                let force = self.surface.force(separation, radii) + added.get(k).copied().unwrap_or_default();
                [force, -force]
            };
            let repulsion = near.summed(near.pairs().enumerate().map(on_pair));
            forces.iter_mut().zip(repulsion).for_each(|(force, repulsion)| *force += repulsion);
            if cell.boundaries().walls() > 0 {
                let at_wall = |row, to: ToWall, radius| {
                    self.surface.force(to.axis * to.distance, PairKind::Wall(radius))
                        + ahead.map_or(Vector::ZERO, |ahead| self.expected_at_wall(ahead, row, (to, radius)))
                };
                add_at_walls(&mut forces, (particles, cell), at_wall);
            }
        }
        Loads { forces, torques: self.torques(particles), stresslets: Vec::new() }
    }

    /// For each pair, minus the change of the force on the first sphere by [`SurfaceForces::resistance`] at the
    /// predicted velocities. Collective.
    fn expected(&self, near: &Near, ahead: &Prediction) -> Vec<Vector> {
        let (relative, strain_rate) = (near.differences(ahead.velocities), ahead.strain_rate.tensor());
        let of_pair = |((separation, radii, _), velocity): ((Vector, [f64; 2], _), Vector)| {
            let distance = separation.length();
            let axis = separation / distance;
            axis * (-self.surface.resistance(ahead.time, distance, radii)
                * axis.dot(velocity + strain_rate * separation))
        };
        near.pairs().zip(relative).map(of_pair).collect()
    }

    /// [`Self::expected`] for a sphere and a wall; no flow has a velocity normal to the wall at the wall.
    fn expected_at_wall(&self, ahead: &Prediction, row: usize, (to, radius): (ToWall, f64)) -> Vector {
        let resistance = self.surface.resistance(ahead.time, to.distance, PairKind::Wall(radius));
        let velocity = ahead.velocities[row] - ahead.strain_rate.tensor() * (to.axis * to.distance);
        to.axis * (resistance * to.axis.dot(velocity))
    }

    /// Repulsion and attraction.
    pub fn surface(&self) -> SurfaceForces {
        self.surface
    }

    /// Gap over the mean radius up to which spheres repel each other; 0 without repulsion.
    pub fn range(&self) -> f64 {
        self.range
    }

    /// Centre distance up to which the repulsion contributes an implicit resistance; `None` without repulsion.
    pub fn reach_of_springs(&self, largest_radius: f64) -> Option<f64> {
        self.surface.repulsion.map(|repulsion| repulsion.reach([largest_radius; 2]))
    }

    /// Contribution of each of this rank's particles to the first moments of repulsion or attraction: a pair at `x_i`
    /// and `x_j` with the force `F` on the first contributes `-(x_i - x_j) F / 2` to each; a sphere at a wall takes the
    /// whole moment, with the nearest point of the wall as `x_j`. Empty without such forces. With velocities `beyond`
    /// the predicted ones, the repulsion changes by [`SurfaceForces::resistance`] times these. Collective.
    pub fn moments(
        &self,
        which: Surface,
        particles: &Particles,
        (cell, partition): (&PeriodicBox, &Partition),
        beyond: Option<&Prediction>,
    ) -> Vec<Tensor> {
        let force = match which {
            Surface::Repulsion => self.surface.repulsion,
            Surface::Attraction => self.surface.attraction,
        };
        let (Some(force), Some(near)) = (force, &self.near) else { return Vec::new() };
        let near = near.find(particles, (cell, partition));
        let taken_back = beyond.map(|ahead| self.expected(&near, ahead)).unwrap_or_default();
        let of_pair = |(k, (separation, radii, _)): (usize, (Vector, [f64; 2], _))| {
            let force = force.force(separation, radii) - taken_back.get(k).copied().unwrap_or_default();
            let half = Tensor::from_cols(separation * force.x, separation * force.y, separation * force.z) * 0.5;
            [half, half]
        };
        let mut moments = near.summed(near.pairs().enumerate().map(of_pair));
        let at_wall = |row, to: ToWall, radius| {
            let taken_back = beyond.map_or(Vector::ZERO, |ahead| self.expected_at_wall(ahead, row, (to, radius)));
            let force = force.force(to.axis * to.distance, PairKind::Wall(radius)) - taken_back;
            let arm = to.axis * to.distance;
            Tensor::from_cols(arm * force.x, arm * force.y, arm * force.z)
        };
        add_at_walls(&mut moments, (particles, cell), at_wall);
        moments
    }

    /// Sums over this rank's particles of the x and y components of steady forces, and of the first moments along z of
    /// the x and y components of forces, torques included.
    pub fn sums_along_walls(&self, particles: &Particles) -> [f64; 4] {
        let (forces, torques) = (self.steady_forces(particles), self.torques(particles));
        let at = |list: &[Vector], row: usize| list.get(row).copied().unwrap_or_default();
        let mut sums = [0.0; 4];
        for (row, place) in particles.positions.iter().enumerate() {
            let (f, t) = (at(&forces, row), at(&torques, row));
            let own = [f.x, f.y, place.z * f.x + 0.5 * t.y, place.z * f.y - 0.5 * t.x];
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        sums
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

/// Adds the contribution of each wall to each particle, as a function of its row and radius.
fn add_at_walls<T: AddAssign>(
    sums: &mut [T],
    (particles, cell): (&Particles, &PeriodicBox),
    at_wall: impl Fn(usize, ToWall, f64) -> T,
) {
    for (row, sum) in sums.iter_mut().enumerate() {
        for to in cell.to_walls(particles.positions[row]) {
            *sum += at_wall(row, to, particles.radii[row]);
        }
    }
}
