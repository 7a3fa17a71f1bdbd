//! Pairs of particles within a cutoff.

use crate::cells::{CellNeighbourhood, Cells, Centre};
use crate::parallel::{self, MeasuredLoop};
use crate::{Neighbours, PeriodicBox, Vector};
use rayon::prelude::*;

/// A pair of particles within a cutoff: rows `i` and `j` among local particles and ghosts, and the lattice steps from
/// `j` to its image near `i`. A particle and its own image are also a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// Row of the first particle, which this rank or another owns.
    pub i: u32,
    /// Row of the second particle.
    pub j: u32,
    /// Lattice steps added to the second particle's position.
    pub steps: [i8; 3],
}

impl Pair {
    fn reversed(self) -> Self {
        Self { i: self.j, j: self.i, steps: self.steps.map(|s| -s) }
    }

    /// Vector from the first particle to that image of the second.
    pub fn separation(&self, cell: &PeriodicBox, positions: &[Vector]) -> Vector {
        let d = positions[self.j as usize] - positions[self.i as usize];
        if self.steps == [0; 3] { d } else { d + cell.lattice(self.steps.map(i32::from)) }
    }
}

/// A half neighbour list: all pairs within a cutoff, each once over all images and ranks, ordered by the first
/// particle.
#[derive(Debug, Clone, Default)]
pub struct Pairs {
    list: Vec<Pair>,
}

/// Particles whose pairs one thread selects at a time.
const BATCH: usize = 256;

impl Pairs {
    /// Finds the pairs among the local particles and ghosts of this rank, the first `owned` of which it owns. `ids` are
    /// unique and the same on all ranks; they decide which rank keeps a pair that two ranks find.
    pub fn find(cell: &PeriodicBox, positions: &[Vector], ids: &[u64], owned: usize, cutoff: f64) -> Self {
        if cutoff <= 0.0 || positions.is_empty() {
            return Self::default();
        }
        let neighbours = Neighbours::find(cell, positions, positions.len(), cutoff);
        let list = (0..positions.len())
            .into_par_iter()
            .measured()
            .flat_map_iter(|i| {
                let pairs = neighbours.of(i).iter().map(|n| Pair { i: i as u32, j: n.row, steps: n.steps });
                let mut kept: Vec<Pair> = pairs.filter(|pair| is_kept(pair, ids, owned)).collect();
                kept.sort_unstable_by_key(|p| (p.j, p.steps));
                kept
            })
            .collect();
        Self { list }
    }

    /// The same pairs in the same order, from the neighbours within the cutoff of the particles that this rank owns.
    pub fn of(neighbours: &Neighbours, ids: &[u64], owned: usize) -> Self {
        let sort = |pairs: &mut [Pair]| pairs.sort_unstable_by_key(|pair| (pair.i, pair.j, pair.steps));
        let of_row =
            |row: usize| neighbours.of(row).iter().map(move |n| Pair { i: row as u32, j: n.row, steps: n.steps });
        let of_batch = |batch: usize| {
            let mut pairs = Vec::new();
            for row in batch * BATCH..owned.min((batch + 1) * BATCH) {
                let first = pairs.len();
                pairs.extend(of_row(row).filter(|pair| is_kept(pair, ids, owned)));
                sort(&mut pairs[first..]);
            }
            pairs
        };
        let batches: Vec<Vec<Pair>> = (0..owned.div_ceil(BATCH)).into_par_iter().map(of_batch).measured().collect();
        let mut list = parallel::concat(batches);
        if ids.len() > owned {
            // Pairs whose first particle another rank owns come last, like its ghost.
            let of_others = (0..owned).flat_map(of_row).filter(|pair| pair.j as usize >= owned).map(Pair::reversed);
            let mut kept: Vec<Pair> = of_others.filter(|pair| is_kept(pair, ids, owned)).collect();
            sort(&mut kept);
            list.extend(kept);
        }
        Self { list }
    }

    /// The pairs for which `stays` is true, given their rows.
    #[must_use]
    pub fn retained(mut self, stays: impl Fn(usize, usize) -> bool) -> Self {
        self.list.retain(|pair| stays(pair.i as usize, pair.j as usize));
        self
    }

    /// The pairs.
    pub fn list(&self) -> &[Pair] {
        &self.list
    }
}

/// Folds over the pairs of different particles within a cutoff, all on this rank, without storing a list. Each pair
/// is visited once, in no particular order, with its rows, the smaller first, and the vector from the first to the
/// image of the second. Returns partial results, each begun by `start` and folded over a part of the pairs.
pub fn fold_pairs<T: Send>(
    cell: &PeriodicBox,
    positions: &[Vector],
    cutoff: f64,
    start: impl Fn() -> T + Sync,
    visit: impl Fn(&mut T, [u32; 2], Vector) + Sync,
) -> Vec<T> {
    let search = SearchedParticles { cell, positions, total: positions.len(), cutoff };
    fold_some_pairs(&search, |_| true, start, visit)
}

/// Particles among which pairs are searched.
pub(crate) struct SearchedParticles<'a> {
    pub cell: &'a PeriodicBox,
    pub positions: &'a [Vector],
    /// Number of particles in the whole box.
    pub total: usize,
    pub cutoff: f64,
}

/// The same for only those pairs whose smaller row satisfies `is_meant`.
pub(crate) fn fold_some_pairs<T: Send>(
    search: &SearchedParticles,
    is_meant: impl Fn(u32) -> bool + Sync,
    start: impl Fn() -> T + Sync,
    visit: impl Fn(&mut T, [u32; 2], Vector) + Sync,
) -> Vec<T> {
    let &SearchedParticles { cell, positions, total, cutoff } = search;
    let cells = Cells::sort_among(cell, positions, cutoff, total);
    let share = cells.count().div_ceil(4 * parallel::parts());
    (0..cells.count().div_ceil(share))
        .into_par_iter()
        .map(|part| {
            let (mut seen, mut around) = (start(), CellNeighbourhood::default());
            for home in part * share..cells.count().min((part + 1) * share) {
                if !cells.members(home).is_empty() {
                    cells.collect_around(cell, home, &mut around);
                }
                for &i in cells.members(home).iter().filter(|row| is_meant(**row)) {
                    let other = |j: u32, separation: Vector| visit(&mut seen, [i, j], separation);
                    let centre = Centre { position: positions[i as usize], row: i };
                    around.each_later(&cells, centre, cutoff, other);
                }
            }
            seen
        })
        .measured()
        .collect()
}

/// Whether this rank keeps a pair. Of the two orders of a pair, the one with the smaller id first is kept; of a
/// particle and its own image, the one with positive steps. If two ranks own the particles, the owner of the first
/// keeps the pair if the sum of the ids is even, else the owner of the second.
fn is_kept(pair: &Pair, ids: &[u64], owned: usize) -> bool {
    let (i, j) = (pair.i as usize, pair.j as usize);
    let first = if i == j { pair.steps > [0; 3] } else { ids[i] < ids[j] };
    let keeper = if (ids[i] + ids[j]).is_multiple_of(2) { i } else { j };
    first && keeper < owned
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Boundaries, Comm, Halo, Particles, Partition};
    use proptest::prelude::*;

    fn random(count: u64, cell: &PeriodicBox, seed: f64) -> Vec<Vector> {
        let place = |i: u64| {
            let t = (i as f64 + 1.0) * seed;
            cell.wrap((Vector::new(t * 0.754_877, t * 0.569_840, t * 0.438_579) % Vector::ONE) * cell.edges()).0
        };
        (0..count).map(place).collect()
    }

    /// Distances of all pairs of images, by brute force over lattice steps.
    fn brute_force(cell: &PeriodicBox, positions: &[Vector], cutoff: f64) -> Vec<f64> {
        let mut all = Vec::new();
        let range = -5..=5;
        for (i, &p) in positions.iter().enumerate() {
            for (j, &q) in positions.iter().enumerate().skip(i) {
                for steps in range.clone().flat_map(|x| {
                    let range = range.clone();
                    range.clone().flat_map(move |y| range.clone().map(move |z| [x, y, z]))
                }) {
                    if (0..3).any(|axis| steps[axis] != 0 && !cell.is_periodic(axis)) {
                        continue;
                    }
                    let distance = (q + cell.lattice(steps) - p).length();
                    if distance < cutoff && (i != j || steps > [0; 3]) {
                        all.push(distance);
                    }
                }
            }
        }
        all.sort_by(f64::total_cmp);
        all
    }

    fn distances(pairs: &Pairs, cell: &PeriodicBox, positions: &[Vector]) -> Vec<f64> {
        let mut all: Vec<f64> = pairs.list().iter().map(|p| p.separation(cell, positions).length()).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    fn close(a: &[f64], b: &[f64]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn pairs_are_those_of_brute_force(
            seed in 1.0..100.0, strain in -0.6..0.6, cutoff in 0.2..3.5, count in 1_u64..30,
        ) {
            let cell = PeriodicBox::sheared(Vector::new(2.0, 1.7, 2.4), strain).unwrap();
            let positions = random(count, &cell, seed);
            let ids: Vec<u64> = (0..count).collect();
            let pairs = Pairs::find(&cell, &positions, &ids, count as usize, cutoff);
            prop_assert!(close(&distances(&pairs, &cell, &positions), &brute_force(&cell, &positions, cutoff)));
        }
    }

    /// Boxes that are not periodic along all axes, also with particles outside of them where they are open.
    fn bounded(edges: Vector, places: &[Vector]) -> Vec<(PeriodicBox, Vec<Vector>)> {
        let cell = PeriodicBox::new(edges).unwrap();
        let all = [Boundaries::Walls, Boundaries::Wall, Boundaries::OpenAlongZ, Boundaries::Open];
        let spread = |cell: &PeriodicBox, &place: &Vector| {
            let factor = |axis: usize| if cell.is_periodic(axis) || cell.boundaries().walls() == 2 { 1.0 } else { 1.7 };
            Vector::from_array(std::array::from_fn(|axis| place[axis] * factor(axis) - 0.1 * (factor(axis) - 1.0)))
        };
        let with = |boundaries| {
            let cell = cell.with_boundaries(boundaries).unwrap();
            (cell, places.iter().map(|place| spread(&cell, place)).collect())
        };
        all.map(with).to_vec()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        #[test]
        fn no_pair_is_beyond_a_face_that_does_not_repeat(
            seed in 1.0..100.0, cutoff in 0.2..3.5, count in 1_u64..30,
        ) {
            let edges = Vector::new(2.0, 1.7, 2.4);
            let ids: Vec<u64> = (0..count).collect();
            for (cell, positions) in bounded(edges, &random(count, &PeriodicBox::new(edges).unwrap(), seed)) {
                let pairs = Pairs::find(&cell, &positions, &ids, count as usize, cutoff);
                let (found, expected) = (distances(&pairs, &cell, &positions), brute_force(&cell, &positions, cutoff));
                prop_assert!(close(&found, &expected), "{:?}", cell.boundaries());
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn folded_pairs_are_those_of_the_list(
            seed in 1.0..100.0, strain in -0.6..0.6, cutoff in 0.2..3.5, count in 1_u64..60,
        ) {
            let cell = PeriodicBox::sheared(Vector::new(2.0, 1.7, 2.4), strain).unwrap();
            let positions = random(count, &cell, seed);
            let ids: Vec<u64> = (0..count).collect();
            let pairs = Pairs::find(&cell, &positions, &ids, count as usize, cutoff);
            let others = pairs.list().iter().filter(|pair| pair.i != pair.j);
            let mut expected: Vec<_> = others.map(|p| ([p.i, p.j], p.separation(&cell, &positions))).collect();
            let visit = |seen: &mut Vec<_>, pair: [u32; 2], separation| seen.push((pair, separation));
            let mut found = fold_pairs(&cell, &positions, cutoff, Vec::new, visit).concat();
            for list in [&mut expected, &mut found] {
                // Images of a pair differ by more than round-off.
                list.sort_by_key(|(pair, d)| (*pair, d.to_array().map(|x| (x * 1e6).round() as i64)));
            }
            prop_assert_eq!(found.len(), expected.len());
            for (a, b) in found.iter().zip(&expected) {
                prop_assert!(a.0 == b.0 && (a.1 - b.1).length() < 1e-12, "{:?} is not {:?}", a, b);
            }
        }
    }

    #[test]
    fn every_pair_is_on_one_rank() {
        let cell = PeriodicBox::sheared(Vector::splat(6.0), 0.3).unwrap();
        let everything = random(150, &cell, 7.3);
        each_is_on_one_rank(&cell, &everything, &[1, 2, 3, 4, 7, 13, 16, 64]);
        let straight = random(100, &PeriodicBox::new(Vector::splat(6.0)).unwrap(), 7.3);
        for (cell, everything) in bounded(Vector::splat(6.0), &straight) {
            each_is_on_one_rank(&cell, &everything, &[2, 7, 16]);
        }
    }

    fn each_is_on_one_rank(cell: &PeriodicBox, everything: &[Vector], sizes: &[usize]) {
        let cutoff = 1.1;
        let expected = brute_force(cell, everything, cutoff);
        for &ranks in sizes {
            let found = Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [12, 12]);
                let mut particles = Particles::default();
                for (id, &p) in everything.iter().enumerate().filter(|(id, _)| id % ranks == comm.rank()) {
                    particles.push(id as u64, p, 1.0, 0);
                }
                particles.migrate(&partition, cell);
                let halo = Halo::plan(&partition, cell, &particles.positions, [cutoff; 2]);
                let (mut positions, mut ids) = (particles.positions.clone(), particles.ids.clone());
                halo.extend(&mut positions);
                halo.extend(&mut ids);
                let pairs = Pairs::find(cell, &positions, &ids, particles.len(), cutoff);
                distances(&pairs, cell, &positions)
            });
            let mut found = found.concat();
            found.sort_by(f64::total_cmp);
            assert!(close(&found, &expected), "{ranks} ranks");
        }
    }
}
