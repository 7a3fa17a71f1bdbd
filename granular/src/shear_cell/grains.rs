//! The grains of a shear cell, and their conversion to and from the particle store.

use super::{CellModel, GrainMotion};
use crate::parameter::{ParameterError, require};
use domain::{Number, Particles, PeriodicBox, Random, Vector};

/// Positions and motions of all grains, in the order of their ids.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grains {
    /// Centres; their coordinates along periodic axes are inside the box.
    pub positions: Vec<Vector>,
    /// Velocities and angular velocities.
    pub motions: Vec<GrainMotion>,
}

impl Grains {
    /// Grains of a particle store; missing columns `velocity` and `angular_velocity` count as zero. Refuses radii
    /// that differ from the model's.
    pub fn from_particles(model: &CellModel, particles: &Particles) -> Result<Self, ParameterError> {
        let vectors = |name: &str| -> Vec<Vector> {
            let found = particles.rows(name).map(|rows| rows.iter().copied().map(Vector::from_array).collect());
            found.unwrap_or_else(|| vec![Vector::ZERO; particles.len()])
        };
        let motions = vectors("velocity").into_iter().zip(vectors("angular_velocity"));
        let grains = Self {
            positions: particles.positions.to_vec(),
            motions: motions.map(|(velocity, spin)| GrainMotion { velocity, spin }).collect(),
        };
        let radius = model.radius();
        for r in &particles.radii {
            let allowed = format_args!("half the cell's diameter, {}", Number(radius));
            require((r / radius - 1.0).abs() < 1e-12, "radius", Number(*r), allowed)?;
        }
        Ok(grains)
    }

    /// The grains as a store with the columns `velocity` and `angular_velocity`.
    pub fn to_particles(&self, model: &CellModel) -> Particles {
        let count = self.len();
        let mut particles = Particles::numbered(self.positions.clone(), vec![model.radius(); count], vec![0; count]);
        particles.vectors("velocity").iter_mut().zip(&self.motions).for_each(|(v, m)| *v = m.velocity);
        particles.vectors("angular_velocity").iter_mut().zip(&self.motions).for_each(|(w, m)| *w = m.spin);
        particles
    }

    /// Sets the velocities: the linear profile between the walls plus, in each component, a normal deviate of
    /// standard deviation `agitation`; no spin.
    pub fn set_velocities(&mut self, model: &CellModel, agitation: f64, seed: u64) {
        let p = model.parameters();
        for (i, (position, motion)) in self.positions.iter().zip(&mut self.motions).enumerate() {
            let mut random = Random::new(seed, i as u64);
            let noise = Vector::from(std::array::from_fn(|_| random.normal()[0]));
            let along = Vector::X * p.speed * (1.0 - position.y / p.height);
            *motion = GrainMotion { velocity: along + noise * agitation, spin: Vector::ZERO };
        }
    }

    /// Number of grains.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no grains.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Kinetic energy.
    pub fn energy(&self, model: &CellModel) -> f64 {
        model.mass() * self.motions.iter().map(|m| m.energy(model.radius())).sum::<f64>()
    }

    /// Momentum.
    pub fn momentum(&self, model: &CellModel) -> Vector {
        model.mass() * self.motions.iter().map(|m| m.velocity).sum::<Vector>()
    }

    /// One third of the mean squared velocity relative to the mean: the granular temperature of a gas at rest.
    pub fn temperature(&self) -> f64 {
        let count = self.len() as f64;
        let mean = self.motions.iter().map(|m| m.velocity).sum::<Vector>() / count;
        self.motions.iter().map(|m| (m.velocity - mean).length_squared()).sum::<f64>() / (3.0 * count)
    }

    /// Deepest overlap of two grains, over the diameter; negative if none overlap (then only pairs within a
    /// quarter of a diameter are seen).
    pub fn deepest_overlap(&self, model: &CellModel) -> f64 {
        let diameter = model.parameters().diameter;
        let ids: Vec<u64> = (0..self.len() as u64).collect();
        let cell = periodic_box(model, 1.25 * diameter, model.parameters().height);
        let pairs = domain::Pairs::find(&cell, &self.positions, &ids, self.len(), 1.25 * diameter);
        let gap = |p: &domain::Pair| p.separation(&cell, &self.positions).length() / diameter - 1.0;
        -pairs.list().iter().map(gap).fold(0.25, f64::min)
    }
}

/// The cell as a periodic box in which no pair reaches across a wall: walled axes are longer by `margin`.
pub(super) fn periodic_box(model: &CellModel, margin: f64, height: f64) -> PeriodicBox {
    let mut edges = Vector { y: height, ..model.edges() };
    for k in 0..3 {
        edges[k] += if model.is_walled(k) { margin } else { 0.0 };
    }
    PeriodicBox::new(edges).expect("a model's edges are positive")
}

/// Wraps positions into the box along its periodic axes.
pub(super) fn wrap(model: &CellModel, positions: &mut [Vector]) {
    let edges = model.edges();
    for k in (0..3).filter(|&k| !model.is_walled(k)) {
        for x in &mut *positions {
            x[k] = x[k].rem_euclid(edges[k]);
            // Just below zero, rem_euclid rounds to the edge itself.
            x[k] = if x[k] >= edges[k] { 0.0 } else { x[k] };
        }
    }
}
