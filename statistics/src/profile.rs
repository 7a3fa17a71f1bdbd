//! Concentration along an axis.

use crate::{State, Store};
use domain::{PeriodicBox, Vector};
use std::f64::consts::PI;

/// Volume fraction of each species in slabs perpendicular to an axis; a sphere contributes to every slab the volume
/// of its slice there.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    axis: usize,
    edge: f64,
    slab_volume: f64,
    samples: f64,
    /// `[species][slab]`
    volumes: Vec<f64>,
}

/// Number of slabs of a profile.
const SLABS: usize = 64;

impl Profile {
    /// Along an axis of a box, for `species` species.
    pub fn new(cell: &PeriodicBox, axis: usize, species: usize) -> Self {
        let slab_volume = cell.volume() / SLABS as f64;
        Self { axis, edge: cell.edges()[axis], slab_volume, samples: 0.0, volumes: vec![0.0; species * SLABS] }
    }

    /// Adds all spheres at one time.
    pub fn add(&mut self, positions: &[Vector], radii: &[f64], species: &[u32]) {
        let height = self.edge / SLABS as f64;
        for ((position, &radius), &kind) in positions.iter().zip(radii).zip(species) {
            let centre = position[self.axis];
            let slabs = &mut self.volumes[kind as usize * SLABS..][..SLABS];
            let first = ((centre - radius) / height).floor() as i64;
            let last = ((centre + radius) / height).floor() as i64;
            for slab in first..=last {
                let below = |edge: i64| cap(edge as f64 * height - centre, radius);
                slabs[slab.rem_euclid(SLABS as i64) as usize] += below(slab + 1) - below(slab);
            }
        }
        self.samples += 1.0;
    }

    /// Sums of the volumes, which may be taken over parts of the particles.
    pub fn volumes(&self) -> &[f64] {
        &self.volumes
    }

    /// The same samples with these sums.
    #[must_use]
    pub fn with_volumes(&self, volumes: Vec<f64>) -> Self {
        Self { volumes, ..self.clone() }
    }

    /// Positions along the axis and the volume fractions of a species there.
    pub fn fractions(&self, species: usize) -> Vec<(f64, f64)> {
        let place = |slab: usize| (slab as f64 + 0.5) * self.edge / SLABS as f64;
        let volumes = self.volumes[species * SLABS..][..SLABS].iter().enumerate();
        volumes.map(|(slab, volume)| (place(slab), volume / self.samples / self.slab_volume)).collect()
    }
}

/// Volume of a sphere below a height relative to its centre.
pub(crate) fn cap(height: f64, radius: f64) -> f64 {
    let z = height.clamp(-radius, radius);
    PI * (radius * radius * (z + radius) - (z.powi(3) + radius.powi(3)) / 3.0)
}

impl State for Profile {
    fn visit(&mut self, store: &mut dyn Store) {
        store.number(&mut self.samples);
        store.numbers(&mut self.volumes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_are_in_their_slabs_with_all_their_volume() {
        let cell = PeriodicBox::new(Vector::new(8.0, 8.0, 16.0)).unwrap();
        let mut profile = Profile::new(&cell, 2, 2);
        let positions = [Vector::new(1.0, 1.0, 0.3), Vector::new(4.0, 4.0, 8.0)];
        for _ in 0..3 {
            profile.add(&positions, &[1.0, 2.0], &[0, 1]);
        }
        let slab = cell.volume() / SLABS as f64;
        for (kind, radius) in [(0, 1.0_f64), (1, 2.0)] {
            let fractions = profile.fractions(kind);
            let volume: f64 = fractions.iter().map(|(_, f)| f * slab).sum();
            assert!((volume - 4.0 / 3.0 * PI * radius.powi(3)).abs() < 1e-12);
            let centre = positions[kind].z;
            for (z, f) in &fractions {
                let away = (z - centre - ((z - centre) / 16.0).round() * 16.0).abs();
                assert_eq!(*f > 0.0, away < radius + 0.125, "{z}");
            }
        }
        // The slab of height h next to the middle has a cross-section of nearly pi a^2.
        let middle = profile.fractions(1)[32].1 * 64.0;
        assert!((middle - PI * (4.0 - 0.25_f64.powi(2) / 3.0)).abs() < 1e-12);
        let mut again = Profile::new(&cell, 2, 2);
        assert!(again.load(&profile.clone().save()));
        assert_eq!(again, profile);
    }
}
