//! Pairs of near particles.

mod local_particles;
mod neighbour_lists;
mod smallest_gap;

use bytemuck::Pod;
use domain::parallel::MeasuredLoop;
use domain::{Bytes, DomainView, ExpectedCounts, Pair, Pairs, Particles, Vector};
pub use local_particles::LocalParticles;
pub use neighbour_lists::{NearParticles, NeighbourLists};
use rayon::prelude::*;
pub use smallest_gap::smallest_gap;
use std::borrow::Cow;
use std::ops::AddAssign;
use std::rc::Rc;

/// Pairs within a cutoff, with the halo for ghosts.
pub struct PairsWithHalo {
    present: Rc<LocalParticles>,
    pairs: Pairs,
}

/// A pair of near particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeparatedPair {
    /// Vector from the centre of the first to that of the second.
    pub separation: Vector,
    /// Radii.
    pub radii: [f64; 2],
    /// Lattice steps from the second particle to its image.
    pub steps: [i32; 3],
}

/// Smallest number of pairs per thread.
const BATCH: usize = 1024;

impl PairsWithHalo {
    /// Finds the pairs whose centres are closer than `cutoff`, except those within a rigid body. Collective.
    pub fn find(particles: &Particles, domain: DomainView, cutoff: f64) -> Self {
        let present = LocalParticles::new(particles, domain, cutoff);
        let pairs = Pairs::find(domain.cell, present.positions(), present.ids(), particles.len(), cutoff);
        let pairs = if present.has_bodies() { pairs.retained(|i, j| !present.are_of_one_body(i, j)) } else { pairs };
        Self { present: Rc::new(present), pairs }
    }

    /// Memory of the pairs within a distance, with copies of the particles and ghosts.
    pub fn bytes(distance: f64, expected: &ExpectedCounts) -> Bytes {
        let (owned, present) = (expected.owned(), expected.present(distance));
        let copies = Bytes::list::<(Vector, f64, u64)>(present);
        copies.then(Pairs::bytes(owned, present, expected.neighbours(distance)))
    }

    /// Sums, for each of this rank's particles, the contributions of its pairs to the first and the second particle;
    /// `of_pairs` has one item for each of [`PairsWithHalo::pairs`]. Collective.
    pub fn summed<T: Pod + AddAssign>(&self, of_pairs: impl Iterator<Item = [T; 2]>) -> Vec<T> {
        let mut sums = vec![T::zeroed(); self.present.ids().len()];
        for (pair, [first, second]) in self.pairs.list().iter().zip(of_pairs) {
            sums[pair.i as usize] += first;
            sums[pair.j as usize] += second;
        }
        self.present.halo().collect(&mut sums);
        sums
    }

    /// Number of particles of this rank.
    pub fn owned(&self) -> usize {
        self.present.owned()
    }

    /// Difference of a vector of each particle, second minus first, for each pair. Collective.
    pub fn differences(&self, values: &[Vector]) -> Vec<Vector> {
        let present = self.present.extended(values);
        let difference = |pair: &Pair| present[pair.j as usize] - present[pair.i as usize];
        self.pairs.list().par_iter().with_min_len(BATCH).map(difference).measured().collect()
    }

    /// Applies a function to each pair, as in [`PairsWithHalo::pairs`], and to its differences of several lists of
    /// vectors, as in [`PairsWithHalo::differences`]. Collective.
    pub fn map<T: Send, const N: usize>(
        &self,
        values: &[Vec<Vector>; N],
        of_pair: impl Fn(SeparatedPair, [Vector; N]) -> T + Sync,
    ) -> Vec<T> {
        let (present, local) = (values.each_ref().map(|list| self.present.extended(list)), self.present.local());
        let made = |pair: &Pair| {
            let difference = |list: &Cow<[Vector]>| list[pair.j as usize] - list[pair.i as usize];
            of_pair(local.pair(pair), present.each_ref().map(difference))
        };
        self.pairs.list().par_iter().with_min_len(BATCH).map(made).measured().collect()
    }

    /// Applies a function to each pair and to the values of its two particles. Collective.
    pub fn with_values<V: Pod + Sync, T: Send>(
        &self,
        values: &[V],
        of_pair: impl Fn(SeparatedPair, [V; 2]) -> T + Sync,
    ) -> Vec<T> {
        let (present, local) = (self.present.extended(values), self.present.local());
        let made = |pair: &Pair| of_pair(local.pair(pair), [pair.i, pair.j].map(|row| present[row as usize]));
        self.pairs.list().par_iter().with_min_len(BATCH).map(made).measured().collect()
    }

    /// The pairs, each on one rank.
    pub fn pairs(&self) -> impl Iterator<Item = SeparatedPair> + '_ {
        self.pairs.list().iter().map(|pair| self.present.local().pair(pair))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::{Comm, Partition, PeriodicBox};

    #[test]
    fn forces_are_equal_and_opposite_on_any_number_of_ranks() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        for ranks in [1, 2, 3, 4, 13, 64] {
            let all = Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [8, 8]);
                let mut particles = if comm.is_first() { smallest_gap::three() } else { Particles::default() };
                particles.migrate(&partition, &cell);
                let near = PairsWithHalo::find(&particles, DomainView { cell: &cell, partition: &partition }, 3.0);
                let force = |d: Vector, radii: [f64; 2]| [d * radii[0] * radii[1], -d * radii[0] * radii[1]];
                let forces = near.summed(near.pairs().map(|pair| force(pair.separation, pair.radii)));
                particles.vectors("force").copy_from_slice(&forces);
                particles.gathered(&partition)
            });
            let forces = all.into_iter().next().unwrap().vectors("force").to_vec();
            // 0 and the image of 1 across the y boundary are 2 apart; no other pair is near.
            assert_eq!(forces, [Vector::new(0.0, -1.0, 0.0), Vector::new(0.0, 1.0, 0.0), Vector::ZERO]);
        }
    }
}
