//! Expected numbers of particles, ghosts and neighbours of a rank, for forecasts of memory.

use crate::{Place, Vector, sphere};

/// Particles distributed uniformly over a box, and the part of it that a rank owns.
#[derive(Debug, Clone, PartialEq)]
pub struct ExpectedCounts {
    edges: Vector,
    /// Radii and the number of particles with each.
    radii: Vec<(f64, f64)>,
    /// Fractions of the box's edges along y and z that this rank owns.
    share: [f64; 2],
}

impl ExpectedCounts {
    /// For particles given by radius and number, in a box, on the rank at a place in the table of ranks.
    pub fn new(edges: Vector, radii: &[(f64, usize)], place: &Place) -> Self {
        let owned = place.owned();
        let share = [0, 1].map(|d| owned[d].len() as f64 / place.lines()[d] as f64);
        Self { edges, radii: radii.iter().map(|&(radius, count)| (radius, count as f64)).collect(), share }
    }

    /// Number of particles of all ranks.
    pub fn total(&self) -> f64 {
        self.radii.iter().map(|(_, count)| count).sum()
    }

    /// Largest radius.
    pub fn largest_radius(&self) -> f64 {
        self.radii.iter().map(|(radius, _)| *radius).fold(0.0, f64::max)
    }

    /// Number of particles that the rank owns.
    pub fn owned(&self) -> f64 {
        self.total() * self.share[0] * self.share[1]
    }

    /// Number of particles that the rank owns, and of ghosts within the distance `reach` of its pencil.
    pub fn present(&self, reach: f64) -> f64 {
        let lengths = [self.edges.y, self.edges.z];
        let part =
            |d: usize| if self.share[d] > 0.0 { (self.share[d] + 2.0 * reach / lengths[d]).min(1.0) } else { 0.0 };
        self.total() * part(0) * part(1)
    }

    /// Mean number of neighbours within a distance: the particles in a sphere of that radius minus the one at its
    /// centre, and at least the density times the volume beyond contact.
    pub fn neighbours(&self, distance: f64) -> f64 {
        self.neighbours_of_pairs(|_, _| distance)
    }

    /// The same for a distance that depends on the two radii.
    pub fn neighbours_of_pairs(&self, distance: impl Fn(f64, f64) -> f64) -> f64 {
        let volume = self.edges.x * self.edges.y * self.edges.z;
        let total = self.total();
        let (mut found, mut beyond_contact) = (0.0, 0.0);
        let kinds = self.kinds();
        for &(a, count) in &kinds {
            for &(b, others) in &kinds {
                let (reach, weight) = (distance(a, b), count / total * others / volume);
                found += weight * sphere::volume(reach);
                beyond_contact += weight * (sphere::volume(reach) - sphere::volume(a + b)).max(0.0);
            }
        }
        (found - 1.0).max(beyond_contact)
    }

    /// Radii and numbers, with neighbouring radii averaged if there are many.
    fn kinds(&self) -> Vec<(f64, f64)> {
        const MOST: usize = 64;
        let each = self.radii.len().div_ceil(MOST).max(1);
        let mean = |kinds: &[(f64, f64)]| {
            let count: f64 = kinds.iter().map(|k| k.1).sum();
            (kinds.iter().map(|k| k.0 * k.1).sum::<f64>() / count, count)
        };
        self.radii.chunks(each).map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Comm, Pairs, Partition, PeriodicBox, random_packing};

    /// The expected numbers agree with those of randomly placed spheres.
    #[test]
    fn expected_numbers_are_those_of_random_spheres() {
        let (cell, radii) = (PeriodicBox::new(Vector::splat(32.0)).unwrap(), vec![1.0; 1500]);
        let positions = random_packing(&cell, &radii, 0.0, 3).unwrap();
        let expected = ExpectedCounts::new(cell.edges(), &[(1.0, 1500)], &Place::of(1, 0, [32, 32]));
        let ids: Vec<u64> = (0..1500).collect();
        for distance in [3.0, 4.0, 5.0] {
            let pairs = Pairs::find(&cell, &positions, &ids, 1500, distance).list().len() as f64;
            let found = 2.0 * pairs / 1500.0;
            let expected = expected.neighbours(distance);
            assert!((expected / found - 1.0).abs() < 0.15, "{expected} for {found} within {distance}");
        }
        for (ranks, found) in [(1, 1500.0), (2, 750.0), (4, 375.0)] {
            let place = Place::of(ranks, 0, [32, 32]);
            let expected = ExpectedCounts::new(cell.edges(), &[(1.0, 1500)], &place);
            assert_eq!((expected.owned(), expected.present(0.0)), (found, found));
            let reached = expected.present(2.0);
            let expected = if ranks == 1 { 1500.0 } else { found + 1500.0 * 4.0 / 32.0 };
            assert!((reached - expected).abs() < 1e-9, "{reached} on one of {ranks} ranks");
        }
    }

    #[test]
    fn a_place_is_that_of_the_partition() {
        for ranks in [1, 2, 6, 7, 12] {
            Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [12, 10]);
                let place = Place::of(ranks, comm.rank(), [12, 10]);
                assert_eq!((place.owned(), place.table()), (partition.owned(), partition.table()));
                assert_eq!(&place, partition.place());
            });
        }
    }
}
