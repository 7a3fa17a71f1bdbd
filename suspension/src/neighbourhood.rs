//! Pairs of near particles.

use bytemuck::Pod;
use domain::parallel::{MeasuredLoop, stage};
use domain::{
    Bytes, DomainView, ExpectedCounts, Halo, LocalAndGhosts, Neighbour, Neighbours, Pair, Pairs, Particles, Partition,
    PeriodicBox, Vector, VerletList,
};
use rayon::prelude::*;
use std::cell::RefCell;
use std::ops::AddAssign;

/// Pairs within a cutoff, with the halo for ghosts.
pub struct PairsWithHalo {
    halo: Halo,
    local: LocalPositions,
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

/// Positions and radii of a rank's particles and ghosts.
struct LocalPositions {
    cell: PeriodicBox,
    positions: Vec<Vector>,
    radii: Vec<f64>,
}

impl LocalPositions {
    fn pair(&self, pair: &Pair) -> SeparatedPair {
        let radii = [pair.i, pair.j].map(|row| self.radii[row as usize]);
        let separation = pair.separation(&self.cell, &self.positions);
        SeparatedPair { separation, radii, steps: pair.steps.map(i32::from) }
    }
}

/// Neighbour lists that are reused as particles move.
pub struct NeighbourLists {
    cutoff: f64,
    lists: RefCell<VerletList>,
}

/// Skin over the cutoff. The cutoff is a few radii, so spheres move far before lists are rebuilt, and lists stay short
/// nevertheless.
const SKIN: f64 = 0.25;

/// Smallest number of pairs per thread.
const BATCH: usize = 1024;

impl NeighbourLists {
    /// Range of the lists over the cutoff.
    pub const REACH: f64 = 1.0 + SKIN;

    /// Lists of pairs whose centres are closer than `cutoff`.
    pub fn new(cutoff: f64, partition: &Partition) -> Self {
        Self { cutoff, lists: RefCell::new(Self::lists(cutoff, partition)) }
    }

    fn lists(cutoff: f64, partition: &Partition) -> VerletList {
        VerletList::new(cutoff, partition).with_skin(SKIN)
    }

    /// Continues with another partition of space.
    pub fn repartition(&mut self, partition: &Partition) {
        self.lists = RefCell::new(Self::lists(self.cutoff, partition));
    }

    /// [`PairsWithHalo::find`] by lists that are rebuilt only occasionally. Collective.
    pub fn find(&self, particles: &Particles, domain: DomainView) -> PairsWithHalo {
        let _stage = stage("pairs of forces and steps");
        let mut lists = self.lists.borrow_mut();
        let owned = particles.len();
        PairsWithHalo::by(particles, domain, self.cutoff, |positions, ids| {
            lists.update(domain.cell, &LocalAndGhosts { owned, ids, positions });
            Pairs::of(lists.neighbours(), ids, owned)
        })
    }

    /// Memory of lists up to a distance, which persist.
    pub fn bytes(distance: f64, expected: &ExpectedCounts) -> Bytes {
        let numbers = [distance, distance * Self::REACH].map(|reach| expected.neighbours(reach));
        VerletList::bytes([expected.owned(), expected.present(distance), expected.total()], numbers)
    }
}

impl PairsWithHalo {
    /// Finds the pairs whose centres are closer than `cutoff`. Collective.
    pub fn find(particles: &Particles, domain: DomainView, cutoff: f64) -> Self {
        Self::by(particles, domain, cutoff, |positions, ids| {
            Pairs::find(domain.cell, positions, ids, particles.len(), cutoff)
        })
    }

    /// The pairs that `find` returns for the positions and ids of particles and ghosts.
    fn by(
        particles: &Particles,
        DomainView { cell, partition }: DomainView,
        cutoff: f64,
        find: impl FnOnce(&[Vector], &[u64]) -> Pairs,
    ) -> Self {
        let halo = Halo::plan(partition, cell, &particles.positions, [cutoff; 2]);
        let (mut positions, mut radii, mut ids) =
            (particles.positions.clone(), particles.radii.clone(), particles.ids.clone());
        halo.extend(&mut positions);
        halo.extend(&mut radii);
        halo.extend(&mut ids);
        let pairs = find(&positions, &ids);
        Self { halo, local: LocalPositions { cell: *cell, positions, radii }, pairs }
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
        let mut sums = vec![T::zeroed(); self.halo.present()];
        for (pair, [first, second]) in self.pairs.list().iter().zip(of_pairs) {
            sums[pair.i as usize] += first;
            sums[pair.j as usize] += second;
        }
        self.halo.collect(&mut sums);
        sums
    }

    /// Number of particles of this rank.
    pub fn owned(&self) -> usize {
        self.halo.owned()
    }

    /// Difference of a vector of each particle, second minus first, for each pair. Collective.
    pub fn differences(&self, values: &[Vector]) -> Vec<Vector> {
        let present = self.present(values.to_vec());
        let difference = |pair: &Pair| present[pair.j as usize] - present[pair.i as usize];
        self.pairs.list().par_iter().with_min_len(BATCH).map(difference).measured().collect()
    }

    /// Applies a function to each pair, as in [`PairsWithHalo::pairs`], and to its differences of several lists of
    /// vectors, as in [`PairsWithHalo::differences`]. Collective.
    pub fn map<T: Send, const N: usize>(
        &self,
        values: [Vec<Vector>; N],
        of_pair: impl Fn(SeparatedPair, [Vector; N]) -> T + Sync,
    ) -> Vec<T> {
        let (present, local) = (values.map(|list| self.present(list)), &self.local);
        let made = |pair: &Pair| {
            let difference = |list: &Vec<Vector>| list[pair.j as usize] - list[pair.i as usize];
            of_pair(local.pair(pair), present.each_ref().map(difference))
        };
        self.pairs.list().par_iter().with_min_len(BATCH).map(made).measured().collect()
    }

    /// Vectors of this rank's particles, extended by those of its ghosts.
    fn present(&self, mut values: Vec<Vector>) -> Vec<Vector> {
        self.halo.extend(&mut values);
        values
    }

    /// The pairs, each on one rank.
    pub fn pairs(&self) -> impl Iterator<Item = SeparatedPair> + '_ {
        self.pairs.list().iter().map(|pair| self.local.pair(pair))
    }
}

/// Smallest gap between the surfaces of two particles, of a particle and its own image, or of a particle and a wall.
/// The search proceeds by size, from the largest down: each pass takes particles within a factor of two in size
/// together with all smaller ones, so that the search range for small particles is short. Collective.
pub fn smallest_gap(particles: &Particles, cell: &PeriodicBox, partition: &Partition) -> f64 {
    let (mut smallest, mut limit) = (smallest_gap_at_walls(particles, cell, partition), f64::INFINITY);
    loop {
        let below = particles.radii.iter().copied().filter(|&a| a < limit);
        let mut largest = [below.fold(0.0, f64::max)];
        partition.comm().max(&mut largest);
        if largest[0] == 0.0 {
            return smallest;
        }
        let sizes = [0.5 * largest[0], largest[0]];
        smallest = smallest_gap_of(sizes, smallest, (particles, cell, partition));
        limit = sizes[0].next_up();
    }
}

/// Smallest gap of a particle and a wall; infinite without walls. Collective.
fn smallest_gap_at_walls(particles: &Particles, cell: &PeriodicBox, partition: &Partition) -> f64 {
    if cell.boundaries().walls() == 0 {
        return f64::INFINITY;
    }
    let of_one = |(&place, &radius): (&Vector, &f64)| cell.to_walls(place).map(move |to| to.distance - radius);
    let gaps = particles.positions.iter().zip(&particles.radii).flat_map(of_one);
    let mut smallest = [gaps.fold(f64::INFINITY, f64::min)];
    partition.comm().min(&mut smallest);
    smallest[0]
}

/// Smallest initial search margin, over the shortest edge of the box; it bounds the number of passes for any sizes.
const LEAST_MARGIN: f64 = 1e-9;

/// Smallest gap of the particles in a range of sizes and of those that are not larger, or `known` if that is smaller.
/// Collective.
fn smallest_gap_of(
    [half, largest]: [f64; 2],
    known: f64,
    (particles, cell, partition): (&Particles, &PeriodicBox, &Partition),
) -> f64 {
    // Particles within the range of sizes come first.
    let of = |is_meant: &dyn Fn(f64) -> bool| (0..particles.len()).filter(|&r| is_meant(particles.radii[r])).collect();
    let first: Vec<usize> = of(&|a| a > half && a <= largest);
    let others: Vec<usize> = of(&|a| a <= half);
    let rows: Vec<usize> = first.iter().chain(&others).copied().collect();
    let pick = |r: &usize| (particles.positions[*r], particles.radii[*r]);
    let (positions, radii): (Vec<Vector>, Vec<f64>) = rows.iter().map(pick).unzip();
    // No two centres are farther apart than this, so the search ends.
    let (shortest, farthest) = (cell.edges().min_element(), cell.edges().element_sum());
    let (mut margin, mut smallest) = ((0.2 * largest).max(LEAST_MARGIN * shortest), known);
    loop {
        let cutoff = (2.0 * largest + margin).min(farthest);
        let halo = Halo::plan(partition, cell, &positions, [cutoff; 2]);
        let (mut places, mut sizes) = (positions.clone(), radii.clone());
        halo.extend(&mut places);
        halo.extend(&mut sizes);
        let neighbours = Neighbours::find(cell, &places, first.len(), cutoff);
        let gap = |row: usize, other: Neighbour| {
            let pair = Pair { i: row as u32, j: other.row, steps: other.steps };
            pair.separation(cell, &places).length() - (sizes[row] + sizes[other.row as usize])
        };
        let gaps = (0..first.len()).flat_map(|row| neighbours.of(row).iter().map(move |other| gap(row, other)));
        let mut found = [gaps.fold(smallest, f64::min)];
        partition.comm().min(&mut found);
        smallest = found[0];
        // Pairs beyond the cutoff have gaps larger than the margin.
        if smallest <= margin || cutoff >= farthest {
            return smallest;
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

    #[test]
    fn the_search_ends_for_spheres_of_no_size_to_speak_of() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        let mut particles = three();
        particles.radii = vec![1.0, f64::from_bits(1), f64::from_bits(1)];
        let partition = Partition::new(&Comm::alone(), [8, 8]);
        let gap = smallest_gap(&particles, &cell, &partition);
        assert!((gap - 1.0).abs() < 1e-12, "{gap}");
    }

    /// Spheres with sizes over four decades, on several numbers of ranks, against a search over all pairs and images.
    #[test]
    fn the_smallest_gap_of_any_sizes_is_that_of_all_pairs() {
        let cell = PeriodicBox::sheared(Vector::new(9.0, 10.0, 11.0), 0.3).unwrap();
        for seed in 0..6 {
            let mut all = Particles::default();
            for id in 0..40 {
                let mut random = domain::Random::new(seed, id);
                let place = cell.wrap(random.point() * cell.edges()).0;
                all.push(id, place, 1.2 * 10_f64.powf(-4.0 * random.uniform() * seed as f64 / 5.0), 0);
            }
            let gap = |i: usize, j: usize| {
                let apart = cell.nearest_image(all.positions[j] - all.positions[i]).length();
                apart - all.radii[i] - all.radii[j]
            };
            let pairs = (0..40).flat_map(|i| (0..i).map(move |j| (i, j)));
            let expected = pairs.map(|(i, j)| gap(i, j)).fold(f64::INFINITY, f64::min);
            for ranks in [1, 3] {
                Comm::threads(ranks, |comm| {
                    let partition = Partition::new(&comm, [8, 8]);
                    let mut particles = if comm.is_first() { all.clone() } else { Particles::default() };
                    particles.migrate(&partition, &cell);
                    assert!((smallest_gap(&particles, &cell, &partition) - expected).abs() < 1e-12);
                });
            }
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
