//! Particles near each other.

use bytemuck::Pod;
use domain::{Exchange, Pair, Pairs, Particles, Partition, PeriodicBox, Vector};
use std::ops::AddAssign;

/// The pairs within a cutoff, with what is needed of the images that other ranks own.
pub struct Near {
    exchange: Exchange,
    cell: PeriodicBox,
    positions: Vec<Vector>,
    radii: Vec<f64>,
    pairs: Pairs,
}

impl Near {
    /// Finds the pairs whose centres are nearer than `cutoff`. Collective.
    pub fn find(particles: &Particles, cell: &PeriodicBox, partition: &Partition, cutoff: f64) -> Self {
        let exchange = Exchange::plan(partition, cell, &particles.positions, [cutoff; 2]);
        let (mut positions, mut radii, mut ids) =
            (particles.positions.clone(), particles.radii.clone(), particles.ids.clone());
        exchange.extend(&mut positions);
        exchange.extend(&mut radii);
        exchange.extend(&mut ids);
        let pairs = Pairs::find(cell, &positions, &ids, particles.len(), cutoff);
        Self { exchange, cell: *cell, positions, radii, pairs }
    }

    /// For each particle that this rank owns, the sum over its pairs of what `of(separation, radii)` gives to the first
    /// and to the second of a pair. Collective.
    pub fn sums<T: Pod + AddAssign>(&self, of: impl Fn(Vector, [f64; 2]) -> [T; 2]) -> Vec<T> {
        self.summed(self.pairs().map(|(separation, radii, _)| of(separation, radii)))
    }

    /// For each particle that this rank owns, the sum of what its pairs give to the first and to the second of them;
    /// there is one item for each of [`Near::pairs`]. Collective.
    pub fn summed<T: Pod + AddAssign>(&self, of_pairs: impl Iterator<Item = [T; 2]>) -> Vec<T> {
        let mut sums = vec![T::zeroed(); self.exchange.present()];
        for (pair, [first, second]) in self.pairs.list().iter().zip(of_pairs) {
            sums[pair.i as usize] += first;
            sums[pair.j as usize] += second;
        }
        self.exchange.collect(&mut sums);
        sums
    }

    /// Particles that this rank owns.
    pub fn owned(&self) -> usize {
        self.exchange.owned()
    }

    /// Of vectors that each particle of this rank has, for each pair that of the second less that of the first.
    /// Collective.
    pub fn differences(&self, values: &[Vector]) -> Vec<Vector> {
        let mut present = values.to_vec();
        self.exchange.extend(&mut present);
        let difference = |pair: &Pair| present[pair.j as usize] - present[pair.i as usize];
        self.pairs.list().iter().map(difference).collect()
    }

    /// The pairs: from the first centre to the second, both radii, and how many lattice steps the second is from its
    /// own place.
    pub fn pairs(&self) -> impl Iterator<Item = (Vector, [f64; 2], [i32; 3])> + '_ {
        let one = |pair: &Pair| (self.separation(pair), self.radii_of(pair), pair.steps.map(i32::from));
        self.pairs.list().iter().map(one)
    }

    /// The smallest gap between the surfaces of any pair on any rank; infinite if there is no pair. Collective.
    pub fn smallest_gap(&self, partition: &Partition) -> f64 {
        let gap = |pair: &Pair| self.separation(pair).length() - self.radii_of(pair).iter().sum::<f64>();
        let mut smallest = [self.pairs.list().iter().map(gap).fold(f64::INFINITY, f64::min)];
        partition.comm().min(&mut smallest);
        smallest[0]
    }

    fn separation(&self, pair: &Pair) -> Vector {
        pair.separation(&self.cell, &self.positions)
    }

    fn radii_of(&self, pair: &Pair) -> [f64; 2] {
        [self.radii[pair.i as usize], self.radii[pair.j as usize]]
    }
}

/// The smallest gap between the surfaces of any two particles, or of one and its own image. Collective.
pub fn smallest_gap(particles: &Particles, cell: &PeriodicBox, partition: &Partition) -> f64 {
    let mut largest = [particles.radii.iter().copied().fold(0.0, f64::max)];
    partition.comm().max(&mut largest);
    // No two centres are farther apart than this, so the search ends.
    let farthest = cell.edges().element_sum();
    let mut margin = 0.2 * largest[0];
    loop {
        let cutoff = (2.0 * largest[0] + margin).min(farthest);
        let gap = Near::find(particles, cell, partition, cutoff).smallest_gap(partition);
        // A pair beyond the cutoff has a gap of more than the margin.
        if gap <= margin || cutoff >= farthest {
            return gap;
        }
        margin *= 2.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Comm;

    fn three() -> Particles {
        let mut particles = Particles::default();
        particles.push(0, Vector::new(1.0, 1.0, 1.0), 1.0, 0);
        particles.push(1, Vector::new(1.0, 9.0, 1.0), 0.5, 0);
        particles.push(2, Vector::new(6.0, 5.0, 5.0), 1.0, 0);
        particles
    }

    #[test]
    fn forces_are_equal_and_opposite_on_any_number_of_ranks() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        for ranks in [1, 2, 3, 4, 13, 64] {
            let all = Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [8, 8]);
                let mut particles = if comm.is_first() { three() } else { Particles::default() };
                particles.migrate(&partition, &cell);
                let near = Near::find(&particles, &cell, &partition, 3.0);
                let forces = near.sums(|d, radii| [d * radii[0] * radii[1], -d * radii[0] * radii[1]]);
                particles.vectors("force").copy_from_slice(&forces);
                particles.gathered(&partition)
            });
            let forces = all.into_iter().next().unwrap().vectors("force").to_vec();
            // 0 and the image of 1 across the y boundary are 2 apart; nothing else is near.
            assert_eq!(forces, [Vector::new(0.0, -1.0, 0.0), Vector::new(0.0, 1.0, 0.0), Vector::ZERO]);
        }
    }

    #[test]
    fn the_smallest_gap_is_found_near_and_far() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        for ranks in [1, 3, 13, 64] {
            Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [8, 8]);
                let mut particles = if comm.is_first() { three() } else { Particles::default() };
                particles.migrate(&partition, &cell);
                assert!((smallest_gap(&particles, &cell, &partition) - 0.5).abs() < 1e-14);
                let mut alone = if comm.is_first() { three().selected(&[2]) } else { Particles::default() };
                alone.migrate(&partition, &cell);
                assert!((smallest_gap(&alone, &cell, &partition) - 8.0).abs() < 1e-14, "to its own image");
            });
        }
    }
}
