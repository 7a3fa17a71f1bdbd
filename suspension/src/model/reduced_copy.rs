//! Reduced copies of a suspension.

use super::{Model, Start};
use domain::PeriodicBox;

/// Shortest edge of a copy over the largest radius.
const FEWEST_RADII: f64 = 8.0;

impl Model {
    /// The same suspension with at most about `most` spheres: in a box of the same shape, at random positions, without
    /// bonds or traps. `None` if the caller provides the positions, if there are rigid bodies or filaments, or if there
    /// is no valid copy.
    #[must_use]
    pub fn with_at_most(&self, most: f64) -> Option<Self> {
        if self.start == Start::Given {
            return None;
        }
        let total: f64 = self.species.iter().map(|species| species.count.unwrap_or(0) as f64).sum();
        let largest = self.species.iter().map(|species| species.radius).fold(0.0, f64::max);
        let least = FEWEST_RADII * largest / self.cell.edges().min_element();
        let scale = (most / total).cbrt().max(least);
        if scale >= 1.0 {
            return Some(self.clone());
        }
        if !self.placed_together().is_empty() {
            return None;
        }
        let mut parameters = self.0.clone();
        let cell = match self.cell.axes() {
            None => PeriodicBox::new(self.cell.edges() * scale),
            Some(_) => PeriodicBox::of_lattice(self.cell.lattice_vectors().map(|vector| vector * scale)),
        };
        parameters.cell = cell.and_then(|cell| cell.with_boundaries(self.cell.boundaries())).ok()?;
        if let Start::Cloud { radius, .. } = &mut parameters.start {
            *radius *= scale;
        }
        parameters.bonds.clear();
        parameters.traps.clear();
        for species in &mut parameters.species {
            species.count = species.count.map(|count| ((count as f64 * scale.powi(3)).round() as u64).max(1));
        }
        if matches!(parameters.start, Start::Positions(_)) {
            parameters.start = Start::Random { minimum_gap: 0.0 };
        }
        Self::new(parameters).ok()
    }
}

#[cfg(test)]
mod tests {
    use crate::Model;
    use crate::model::{Parameters, Species, Start};
    use domain::{PeriodicBox, Vector};
    use std::f64::consts::PI;

    fn model(counts: [u64; 2], edges: [f64; 3]) -> Model {
        let species = vec![Species::new("small", 1.0, counts[0]), Species::new("large", 2.0, counts[1])];
        let cell = PeriodicBox::new(Vector::from_array(edges)).unwrap();
        Model::new(Parameters::new(cell, 1.0, species, 0.1, 10)).unwrap()
    }

    fn fraction(model: &Model) -> f64 {
        let volume = |s: &Species| s.count.unwrap() as f64 * 4.0 / 3.0 * PI * s.radius.powi(3);
        model.species.iter().map(volume).sum::<f64>() / model.cell.volume()
    }

    #[test]
    fn a_copy_is_like_the_whole() {
        let whole = model([80_000, 20_000], [100.0, 150.0, 200.0]);
        let copy = whole.with_at_most(4000.0).unwrap();
        let counts: Vec<u64> = copy.species.iter().map(|s| s.count.unwrap()).collect();
        assert_eq!(counts, [3200, 800]);
        assert!((fraction(&copy) / fraction(&whole) - 1.0).abs() < 1e-12);
        let edges = copy.cell.edges();
        assert!((edges.y / edges.x - 1.5).abs() < 1e-12 && (edges.z / edges.x - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_small_one_is_its_own_copy_and_a_thin_box_stays_wide_enough() {
        let small = model([20, 5], [20.0; 3]);
        assert_eq!(small.with_at_most(4000.0), Some(small));
        let flat = model([80_000, 20_000], [20.0, 400.0, 400.0]);
        let copy = flat.with_at_most(1000.0).unwrap();
        assert!((copy.cell.edges().x - 16.0).abs() < 1e-12, "{:?}", copy.cell);
        let mut parameters = (*flat).clone();
        parameters.start = Start::Given;
        assert_eq!(Model::new(parameters).unwrap().with_at_most(1000.0), None);
    }
}
