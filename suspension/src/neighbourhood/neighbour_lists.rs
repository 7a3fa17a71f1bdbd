//! Neighbour lists of a suspension, shared by everything that needs near pairs.

use super::smallest_gap::{smallest_gap, smallest_gap_at_walls};
use super::{LocalParticles, PairsWithHalo};
use domain::parallel::{least, stage};
use domain::{
    Bytes, DomainView, ExpectedCounts, LocalAndGhosts, Neighbours, Pair, Pairs, Particles, Partition, VerletList,
};
use std::cell::{RefCell, RefMut};
use std::rc::Rc;

/// Neighbour lists up to given ranges, which forces, contacts, bonds, the control of gaps and observables share. They
/// are rebuilt only when a particle has moved too far. Particles and ghosts are collected, and followed by the lists,
/// once for each configuration, however many users ask for neighbours in it.
#[derive(Default)]
pub struct NeighbourLists {
    /// From the longest range to the shortest.
    levels: RefCell<Vec<Level>>,
}

/// Neighbours within a range of each particle of a rank, by row. Each pair is in the lists of both of its particles.
pub struct NearParticles {
    /// Particles and ghosts.
    pub present: Rc<LocalParticles>,
    /// Neighbours.
    pub neighbours: Neighbours,
}

/// A list, which serves its range and somewhat shorter ones.
struct Level {
    range: f64,
    lists: VerletList,
    /// Particles and ghosts in the configuration of the lists.
    present: Option<Rc<LocalParticles>>,
}

/// Skin over the cutoff. The cutoff is a few radii, so spheres move far before lists are rebuilt, and lists stay short
/// nevertheless.
const SKIN: f64 = 0.25;

/// Largest ratio of two ranges that share a list. The number of entries grows with the cube of the range: beyond this
/// ratio it takes longer to visit them than to follow the particles by a second, shorter list.
const SHARED: f64 = 1.6;

impl NeighbourLists {
    /// Range of the lists over the cutoff.
    pub const REACH: f64 = 1.0 + SKIN;

    /// Lists for distances of centres up to each of the ranges.
    pub fn new(ranges: impl IntoIterator<Item = f64>, partition: &Partition) -> Self {
        let mut ranges: Vec<f64> = ranges.into_iter().collect();
        ranges.sort_unstable_by(|a, b| b.total_cmp(a));
        let mut levels: Vec<Level> = Vec::new();
        for range in ranges {
            if levels.last().is_none_or(|level| SHARED * range < level.range) {
                let lists = VerletList::new(range, partition).with_skin(SKIN);
                levels.push(Level { range, lists, present: None });
            }
        }
        Self { levels: RefCell::new(levels) }
    }

    /// Particles that are closer than `range` to each particle and not of the same rigid body. A range beyond those of
    /// the lists takes a search. Collective.
    pub fn near(&self, particles: &Particles, domain: DomainView, range: f64) -> NearParticles {
        let _stage = stage("pairs of forces and steps");
        let mut levels = self.levels();
        if let Some(level) = levels.iter_mut().rev().find(|level| level.range >= range) {
            let present = level.follow(particles, domain);
            let neighbours = present.of_others(level.lists.within(range));
            return NearParticles { present, neighbours };
        }
        let present = Rc::new(LocalParticles::new(particles, domain, range));
        let found = Neighbours::find(domain.cell, present.positions(), particles.len(), range);
        let neighbours = present.of_others(found);
        NearParticles { present, neighbours }
    }

    /// Pairs whose centres are closer than `range`, each once, as [`PairsWithHalo::find`] finds them. Collective.
    pub fn pairs(&self, particles: &Particles, domain: DomainView, range: f64) -> PairsWithHalo {
        let NearParticles { present, neighbours } = self.near(particles, domain, range);
        let pairs = Pairs::of(&neighbours, present.ids(), particles.len());
        PairsWithHalo { present, pairs }
    }

    /// Particles with ghosts at least up to a distance. Collective.
    pub fn present(&self, particles: &Particles, domain: DomainView, distance: f64) -> Rc<LocalParticles> {
        let mut levels = self.levels();
        let level = levels.iter_mut().rev().find(|level| level.range >= distance);
        level.map_or_else(
            || Rc::new(LocalParticles::new(particles, domain, distance)),
            |level| level.follow(particles, domain),
        )
    }

    /// Smallest gap of spheres up to a radius, on all ranks: by the lists, if they reach far enough. Collective.
    pub fn smallest_gap(&self, particles: &Particles, domain: DomainView, largest_radius: f64) -> f64 {
        let levels = self.levels();
        let range = levels.iter().rev().map(|level| level.range).find(|&range| range > 2.0 * largest_radius);
        drop(levels);
        let Some(range) = range else { return smallest_gap(particles, domain) };
        let NearParticles { present, neighbours } = self.near(particles, domain, range);
        let (positions, radii) = (present.positions(), present.radii());
        let gap = |i: usize, j: usize, steps: [i8; 3]| {
            let pair = Pair { i: i as u32, j: j as u32, steps };
            pair.separation(domain.cell, positions).length() - (radii[i] + radii[j])
        };
        let of_row = |row: usize| {
            let gaps = neighbours.of(row).iter().map(|other| gap(row, other.row as usize, other.steps));
            gaps.fold(f64::INFINITY, f64::min)
        };
        let mut smallest = [least(particles.len(), of_row)];
        domain.comm().min(&mut smallest);
        // Pairs beyond the range have larger gaps than this.
        if smallest[0] > range - 2.0 * largest_radius {
            return smallest_gap(particles, domain);
        }
        smallest[0].min(smallest_gap_at_walls(particles, domain))
    }

    fn levels(&self) -> RefMut<'_, Vec<Level>> {
        self.levels.borrow_mut()
    }

    /// Number of searches for the lists so far.
    pub fn searches(&self) -> u64 {
        self.levels().iter().map(|level| level.lists.searches()).sum()
    }

    /// Memory of lists up to a distance, which persist.
    pub fn bytes(distance: f64, expected: &ExpectedCounts) -> Bytes {
        let numbers = [distance, distance * Self::REACH].map(|reach| expected.neighbours(reach));
        VerletList::bytes([expected.owned(), expected.present(distance), expected.total()], numbers)
    }
}

impl Level {
    /// Updates the list to a configuration, unless it is that of the last update. Collective.
    fn follow(&mut self, particles: &Particles, domain: DomainView) -> Rc<LocalParticles> {
        let known = self.present.take().filter(|present| present.is_of(particles, domain.cell));
        let is_new = domain.comm().any(known.is_none());
        let present = known.filter(|_| !is_new).unwrap_or_else(|| {
            let present = LocalParticles::new(particles, domain, self.range);
            let (owned, ids, positions) = (particles.len(), present.ids(), present.positions());
            self.lists.track(domain.cell, &LocalAndGhosts { owned, ids, positions });
            Rc::new(present)
        });
        self.present = Some(Rc::clone(&present));
        present
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::{Comm, PeriodicBox, Random, Vector};

    const RANGES: [f64; 4] = [2.1, 3.0, 1.0, 0.4];

    /// Ranges that differ little share a list, so three lists serve four ranges.
    #[test]
    fn ranges_share_lists() {
        let partition = Partition::new(&Comm::alone(), [8, 8]);
        let lists = NeighbourLists::new(RANGES, &partition);
        let ranges: Vec<f64> = lists.levels().iter().map(|level| level.range).collect();
        assert_eq!(ranges, [3.0, 1.0, 0.4]);
    }

    fn moved(particles: &mut Particles, step: u64) {
        for (position, id) in particles.positions.iter_mut().zip(&particles.ids) {
            *position += (Random::new(step, *id).point() - Vector::splat(0.5)) * 0.15;
        }
    }

    /// Pairs and neighbours within any range are those of a search, beyond the ranges of the lists as well, while
    /// particles move, and the longest list is not searched for in each configuration.
    #[test]
    fn all_see_the_pairs_of_a_search() {
        for ranks in [1, 3] {
            Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [8, 8]);
                let lists = NeighbourLists::new(RANGES, &partition);
                let mut particles = Particles::default();
                for id in (0..200).filter(|id| id % ranks as u64 == comm.rank() as u64) {
                    particles.push(id, Random::new(7, id).point() * 10.0, 0.3, 0);
                }
                for step in 0..12 {
                    let cell = PeriodicBox::sheared(Vector::splat(10.0), 0.01 * step as f64).unwrap();
                    let domain = DomainView { cell: &cell, partition: &partition };
                    moved(&mut particles, step);
                    particles.wrap(&cell);
                    particles.migrate(&partition, &cell);
                    for range in [3.0, 2.1, 2.0, 1.0, 0.4, 4.0] {
                        let expected = PairsWithHalo::find(&particles, domain, range);
                        let found = lists.pairs(&particles, domain, range);
                        assert!(found.pairs().eq(expected.pairs()), "range {range}");
                        let NearParticles { present, neighbours } = lists.near(&particles, domain, range);
                        let fresh = Neighbours::find(&cell, present.positions(), particles.len(), range);
                        assert_eq!(neighbours.count(), fresh.count());
                    }
                    let of_search = smallest_gap(&particles, domain).to_bits();
                    // The lists do not reach far enough for the second radius.
                    for radius in [0.3, 1.6] {
                        assert_eq!(lists.smallest_gap(&particles, domain, radius).to_bits(), of_search);
                    }
                }
                let each: Vec<u64> = lists.levels().iter().map(|level| level.lists.searches()).collect();
                assert!(each[0] < 12, "{each:?}");
            });
        }
    }
}
