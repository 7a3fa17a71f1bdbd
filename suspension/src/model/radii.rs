//! Radii of all particles of a suspension.

use super::{Model, Start};
use domain::{Comm, Particles, sphere};

/// Radii of the particles in ascending order, with the number of particles of each.
#[derive(Debug, Clone, PartialEq)]
pub struct Radii(pub(crate) Vec<(f64, usize)>);

impl Radii {
    /// Radii of the particles of all ranks. Collective.
    pub fn shared(particles: &Particles, comm: &Comm) -> Self {
        let mut radii = particles.radii.clone();
        radii.sort_by(f64::total_cmp);
        let own: Vec<[f64; 2]> =
            radii.chunk_by(|a, b| a.total_cmp(b).is_eq()).map(|equal| [equal[0], equal.len() as f64]).collect();
        let all = comm.all_gather(&own).into_iter().map(|[radius, count]| (radius, count as usize));
        Self::of_kinds(all.collect())
    }

    /// Radii of groups, merging groups of equal radius.
    fn of_kinds(mut kinds: Vec<(f64, usize)>) -> Self {
        kinds.sort_by(|a, b| a.0.total_cmp(&b.0));
        let merged = |equal: &[(f64, usize)]| (equal[0].0, equal.iter().map(|kind| kind.1).sum());
        Self(kinds.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq()).map(merged).collect())
    }

    /// Radii of a model that gives its numbers of particles; `None` if a file determines them.
    pub fn of_model(model: &Model) -> Option<Self> {
        if let Start::Given = model.start {
            return None;
        }
        Some(Self::of_kinds(model.species.iter().map(|s| (s.radius, s.count.unwrap_or(0) as usize)).collect()))
    }

    /// Each radius and its number of particles.
    pub fn kinds(&self) -> &[(f64, usize)] {
        &self.0
    }

    /// Total number of particles.
    pub fn count(&self) -> usize {
        self.0.iter().map(|(_, count)| count).sum()
    }

    /// Total volume of the particles.
    pub fn volume(&self) -> f64 {
        self.0.iter().map(|(radius, count)| sphere::volume(*radius) * *count as f64).sum()
    }

    /// The two smallest radii, if there are two particles.
    pub fn smallest_two(&self) -> Option<[f64; 2]> {
        let mut smallest = self.0.iter().flat_map(|&(radius, count)| std::iter::repeat_n(radius, count.min(2)));
        Some([smallest.next()?, smallest.next()?])
    }

    /// Smallest radius; infinite without particles.
    pub fn smallest(&self) -> f64 {
        self.0.first().map_or(f64::INFINITY, |(radius, _)| *radius)
    }

    /// Largest radius; 0 without particles.
    pub fn largest(&self) -> f64 {
        self.0.last().map_or(0.0, |(radius, _)| *radius)
    }
}
