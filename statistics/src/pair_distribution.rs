//! Pair distribution functions g(r) and g(r, angle).

use crate::{State, Store};
use domain::{PeriodicBox, Vector, fold_pairs};
use std::f64::consts::PI;

/// Angle of g(r, angle), defined such that it is uniformly distributed in an isotropic system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Angle {
    /// Angle of the separation in the plane of flow and gradient, from the flow direction x towards y, in `[0, pi)`.
    Azimuth,
    /// Cosine of the angle between the separation and an axis, in `[0, 1)`.
    Cosine(usize),
}

impl Angle {
    /// Angle as a fraction of its range.
    fn share(self, separation: Vector) -> f64 {
        match self {
            Self::Azimuth => (separation.y.atan2(separation.x) / PI).rem_euclid(1.0),
            Self::Cosine(axis) => separation[axis].abs() / separation.length(),
        }
    }

    /// End of the range.
    fn range(self) -> f64 {
        match self {
            Self::Azimuth => PI,
            Self::Cosine(_) => 1.0,
        }
    }
}

/// Pair distribution function of each pair of species,
///
/// ```text
/// g(r) = (pairs found at a distance in [r, r + dr)) / (N_a N_b 4 pi r^2 dr / V),
/// ```
///
/// with `N_a (N_a - 1) / 2` for a species and itself, so that an ideal gas has 1 at any number of particles; and
/// `g(r, angle)` likewise. Periodic images are included, also across the faces of a sheared box, except a particle's
/// own.
#[derive(Debug, Clone, PartialEq)]
pub struct PairDistribution {
    cutoff: f64,
    angle: Angle,
    counts: Vec<u64>,
    samples: f64,
    /// `[pair of species][bin of distance][bin of angle]`
    counted: Vec<f64>,
    volume: f64,
}

/// Number of bins of distance and of angle.
const DISTANCES: usize = 128;
const ANGLES: usize = 24;

impl PairDistribution {
    /// Number of bins of one pair of species.
    pub(crate) const BINS: usize = DISTANCES * ANGLES;

    /// For distances up to `cutoff`, with `counts` particles of each species, in a box of the given volume.
    pub fn new(cutoff: f64, angle: Angle, counts: Vec<u64>, volume: f64) -> Self {
        let pairs = counts.len() * (counts.len() + 1) / 2;
        Self { cutoff, angle, counts, samples: 0.0, counted: vec![0.0; pairs * DISTANCES * ANGLES], volume }
    }

    /// Adds the pairs of all particles at one time.
    pub fn add(&mut self, cell: &PeriodicBox, positions: &[Vector], species: &[u32]) {
        let count = |found: &mut Vec<u32>, pair: [u32; 2], separation| {
            self.count(found, pair.map(|row| species[row as usize]), separation);
        };
        self.add_counted(fold_pairs(cell, positions, self.cutoff, || self.no_pairs(), count));
    }

    /// Largest distance.
    pub fn cutoff(&self) -> f64 {
        self.cutoff
    }

    /// Counts without any pairs.
    pub fn no_pairs(&self) -> Vec<u32> {
        vec![0; self.counted.len()]
    }

    /// Counts a pair of particles of two species, by the vector from the first to the second.
    pub fn count(&self, found: &mut [u32], species: [u32; 2], separation: Vector) {
        found[self.bin(species.map(|s| s as usize), separation)] += 1;
    }

    /// Adds the pairs at one time by their counts, which may be in parts.
    pub fn add_counted(&mut self, parts: impl IntoIterator<Item = Vec<u32>>) {
        for part in parts {
            self.counted.iter_mut().zip(part).for_each(|(found, more)| *found += f64::from(more));
        }
        self.samples += 1.0;
    }

    /// Adds the pairs of another at the same times.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.counted.iter_mut().zip(&other.counted).for_each(|(found, more)| *found += more);
    }

    /// Removes the pairs, but keeps the number of times.
    pub(crate) fn clear_counts(&mut self) {
        self.counted.fill(0.0);
    }

    fn bin(&self, [a, b]: [usize; 2], separation: Vector) -> usize {
        let distance = (separation.length() / self.cutoff * DISTANCES as f64) as usize;
        let angle = (self.angle.share(separation) * ANGLES as f64) as usize;
        (pair_index(a, b) * DISTANCES + distance.min(DISTANCES - 1)) * ANGLES + angle.min(ANGLES - 1)
    }

    /// Pairs of species `a <= b` that have pairs of particles: a species of one particle has no distribution of its
    /// own.
    pub fn species_pairs(&self) -> Vec<[usize; 2]> {
        let all = (0..self.counts.len()).flat_map(|b| (0..=b).map(move |a| [a, b]));
        all.filter(|&pair| self.possible(pair) > 0.0).collect()
    }

    fn possible(&self, [a, b]: [usize; 2]) -> f64 {
        let [n, m] = [a, b].map(|s| self.counts[s] as f64);
        if a == b { 0.5 * n * (n - 1.0) } else { n * m }
    }

    /// Number of pairs of two species in a shell of an ideal gas.
    fn ideal(&self, pair: [usize; 2], distance: usize) -> f64 {
        let edge = |bin: usize| self.cutoff * bin as f64 / DISTANCES as f64;
        let shell = 4.0 / 3.0 * PI * (edge(distance + 1).powi(3) - edge(distance).powi(3));
        self.samples * self.possible(pair) * shell / self.volume
    }

    /// `r` at the middle of each bin and `g(r)` for two species.
    pub fn radial(&self, pair: [usize; 2]) -> Vec<(f64, f64)> {
        let found =
            |bin: usize| self.counted[(pair_index(pair[0], pair[1]) * DISTANCES + bin) * ANGLES..][..ANGLES].iter();
        let g = |bin: usize| (self.middle(bin), found(bin).sum::<f64>() / self.ideal(pair, bin));
        (0..DISTANCES).map(g).collect()
    }

    /// `r`, the angle and `g(r, angle)` for two species.
    pub fn angular(&self, pair: [usize; 2]) -> Vec<(f64, f64, f64)> {
        let angle = |bin: usize| self.angle.range() * (bin as f64 + 0.5) / ANGLES as f64;
        let g = |distance: usize, bin: usize| {
            let found = self.counted[(pair_index(pair[0], pair[1]) * DISTANCES + distance) * ANGLES + bin];
            (self.middle(distance), angle(bin), found * ANGLES as f64 / self.ideal(pair, distance))
        };
        (0..DISTANCES).flat_map(|distance| (0..ANGLES).map(move |bin| g(distance, bin))).collect()
    }

    fn middle(&self, bin: usize) -> f64 {
        self.cutoff * (bin as f64 + 0.5) / DISTANCES as f64
    }
}

fn pair_index(a: usize, b: usize) -> usize {
    let (a, b) = (a.min(b), a.max(b));
    b * (b + 1) / 2 + a
}

impl State for PairDistribution {
    fn visit(&mut self, store: &mut dyn Store) {
        store.number(&mut self.samples);
        store.numbers(&mut self.counted);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Counts;
    use domain::Random;

    /// For particles of the given species.
    fn new(cutoff: f64, angle: Angle, species: &[u32], volume: f64) -> PairDistribution {
        let mut counts = vec![0; species.iter().max().map_or(0, |&s| s as usize + 1)];
        for &s in species {
            counts[s as usize] += 1;
        }
        PairDistribution::new(cutoff, angle, counts, volume)
    }

    fn ideal_gas(angle: Angle, strain: f64) -> PairDistribution {
        let cell = PeriodicBox::sheared(Vector::new(4.0, 5.0, 6.0), strain).unwrap();
        let species: Vec<u32> = (0..300).map(|i| u32::from(i % 3 == 0)).collect();
        // Beyond half the box on purpose: images are pairs of their own.
        let mut found = new(3.0, angle, &species, cell.volume());
        for sample in 0..10 {
            let place = |id| cell.wrap(Random::new(sample, id).point() * cell.edges()).0;
            found.add(&cell, &(0..300).map(place).collect::<Vec<_>>(), &species);
        }
        found
    }

    #[test]
    fn pairs_of_species_come_in_the_order_of_their_counts() {
        let pairs = new(1.0, Angle::Cosine(2), &[0, 1, 2, 0, 1, 2], 8.0).species_pairs();
        assert_eq!(pairs, [[0, 0], [0, 1], [1, 1], [0, 2], [1, 2], [2, 2]]);
        assert!(pairs.iter().enumerate().all(|(k, &[a, b])| pair_index(a, b) == k));
    }

    #[test]
    fn an_ideal_gas_has_one_everywhere_in_straight_and_sheared_boxes() {
        for (angle, strain) in [(Angle::Azimuth, 0.3), (Angle::Cosine(2), 0.0)] {
            let found = ideal_gas(angle, strain);
            for pair in found.species_pairs() {
                assert_eq!(found.radial(pair).len(), DISTANCES);
                for (bin, (r, g)) in found.radial(pair).into_iter().enumerate() {
                    // Five standard deviations of the number of pairs.
                    assert!((g - 1.0).abs() < 5.0 / found.ideal(pair, bin).sqrt(), "{pair:?} {r} {g}");
                }
                let by_angle = found.angular(pair);
                for bin in 0..ANGLES {
                    let ring: f64 = (0..DISTANCES).map(|d| by_angle[d * ANGLES + bin].2 * found.ideal(pair, d)).sum();
                    let expected: f64 = (0..DISTANCES).map(|d| found.ideal(pair, d)).sum();
                    assert!((ring / expected - 1.0).abs() < 5.0 / (expected / ANGLES as f64).sqrt());
                }
            }
        }
    }

    #[test]
    fn one_pair_is_found_at_its_distance_and_angle_across_a_sheared_side() {
        let cell = PeriodicBox::sheared(Vector::splat(10.0), 0.2).unwrap();
        let separation = Vector::new(-1.0, 1.0, 0.0);
        let second = cell.wrap(Vector::new(9.5, 9.8, 5.0) + separation).0;
        let mut found = new(4.0, Angle::Azimuth, &[0, 0], cell.volume());
        found.add(&cell, &[Vector::new(9.5, 9.8, 5.0), second], &[0, 0]);
        let hits: Vec<_> = found.angular([0, 0]).into_iter().filter(|(_, _, g)| *g > 0.0).collect();
        assert_eq!(hits.len(), 1);
        assert!((hits[0].0 - 2.0_f64.sqrt()).abs() < 0.02 && (hits[0].1 - 0.75 * PI).abs() < 0.07, "{hits:?}");
    }

    #[test]
    fn a_lone_particle_has_no_distribution_of_its_own() {
        let found = new(4.0, Angle::Azimuth, &[0, 2, 0], 1000.0);
        assert_eq!(found.species_pairs(), [[0, 0], [0, 2]]);
    }

    /// Three particles: one pair within reach, two with the third particle, counted in two parts.
    #[test]
    fn pairs_may_be_counted_in_parts() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        let (places, species) = ([1.0, 2.0, 4.5].map(|x| Vector::splat(2.0).with_x(x)), [0, 1, 0]);
        let empty = new(3.0, Angle::Azimuth, &species, cell.volume());
        let (mut whole, mut first, mut second) = (empty.clone(), empty.clone(), empty.clone());
        whole.add(&cell, &places, &species);
        let counted = |pair: [usize; 2]| {
            let mut found = empty.no_pairs();
            empty.count(&mut found, pair.map(|row| species[row]), places[pair[1]] - places[pair[0]]);
            [found]
        };
        first.add_counted(counted([0, 1]));
        second.add_counted(counted([1, 2]));
        first.merge(&second);
        assert_eq!(first, whole);
        second.clear();
        assert_eq!(second, PairDistribution { samples: 1.0, ..empty });
    }

    #[test]
    fn a_stream_is_the_batch_to_the_bit() {
        let whole = ideal_gas(Angle::Azimuth, 0.3);
        let mut again = PairDistribution { counted: Vec::new(), samples: 0.0, ..whole.clone() };
        assert!(again.load(&whole.clone().save()));
        assert_eq!(again, whole);
    }
}
