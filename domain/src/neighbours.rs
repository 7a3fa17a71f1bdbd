//! Neighbour lists: the particles within a cutoff of each particle.

use crate::cells::{CellNeighbourhood, Cells, Centre};
use crate::neighbour::Images;
use crate::parallel::{MeasuredLoop, ScatteredWrites, concat};
use crate::{Neighbour, PeriodicBox, Vector};
use rayon::prelude::*;

/// Lists of one batch of particles, concatenated, with the end of each.
#[derive(Default)]
pub(crate) struct Batch {
    pub ends: Vec<(u32, usize)>,
    pub list: Vec<u32>,
}

/// Cells that one thread searches in one batch.
const BATCH: usize = 16;

/// Full neighbour lists: the neighbours within a cutoff of each particle that this rank owns. Each pair is in the
/// lists of both particles, so that lists can be processed independently.
#[derive(Debug, Clone, Default)]
pub struct Neighbours {
    /// Start and end of each particle's list.
    ranges: Vec<[usize; 2]>,
    list: Vec<u32>,
    images: Images,
}

/// Neighbours of one particle.
#[derive(Debug, Clone, Copy)]
pub struct NeighboursOf<'a> {
    list: &'a [u32],
    images: &'a Images,
}

impl<'a> NeighboursOf<'a> {
    /// Number of neighbours.
    pub fn len(self) -> usize {
        self.list.len()
    }

    /// Whether there are no neighbours.
    pub fn is_empty(self) -> bool {
        self.list.is_empty()
    }

    /// Chunks of at most `size` neighbours.
    #[inline(always)]
    pub fn chunks(self, size: usize) -> impl Iterator<Item = Self> {
        self.list.chunks(size).map(move |list| Self { list, images: self.images })
    }

    /// Iterator over the neighbours.
    #[inline(always)]
    pub fn iter(self) -> impl ExactSizeIterator<Item = Neighbour> + 'a {
        self.list.iter().map(move |&entry| self.images.neighbour(entry))
    }
}

impl Neighbours {
    /// Finds the neighbours of the first `owned` particles among all local particles and ghosts.
    pub fn find(cell: &PeriodicBox, positions: &[Vector], owned: usize, cutoff: f64) -> Self {
        Self::find_and(cell, positions, owned, cutoff, |_, _| ())
    }

    /// The same with the list of each particle in the order of a key.
    pub(crate) fn find_in_order<K: Ord>(
        cell: &PeriodicBox,
        positions: &[Vector],
        owned: usize,
        cutoff: f64,
        key: impl Fn(&Neighbour) -> K + Sync,
    ) -> Self {
        let sort =
            |images: &Images, list: &mut [u32]| list.sort_unstable_by_key(|&entry| key(&images.neighbour(entry)));
        Self::find_and(cell, positions, owned, cutoff, sort)
    }

    /// The same with a function that is applied to the list of each particle.
    fn find_and(
        cell: &PeriodicBox,
        positions: &[Vector],
        owned: usize,
        cutoff: f64,
        apply: impl Fn(&Images, &mut [u32]) + Sync,
    ) -> Self {
        if owned == 0 {
            return Self { images: Images::new(cell, cutoff), ..Self::default() };
        }
        let cells = Cells::sort(cell, positions, cutoff);
        let batches: Vec<Batch> = (0..cells.count().div_ceil(BATCH))
            .into_par_iter()
            .map(|batch| {
                let (mut found, mut around) = (Batch::default(), CellNeighbourhood::default());
                for home in batch * BATCH..cells.count().min((batch + 1) * BATCH) {
                    let members = cells.members(home).iter().filter(|&&row| (row as usize) < owned);
                    if members.clone().next().is_some() {
                        cells.collect_around(cell, home, &mut around);
                    }
                    for &row in members {
                        let centre = Centre { position: positions[row as usize], row };
                        let first = found.list.len();
                        around.append_near(&cells, centre, cutoff, &mut found.list);
                        apply(cells.images(), &mut found.list[first..]);
                        found.ends.push((row, found.list.len()));
                    }
                }
                found
            })
            .measured()
            .collect();
        Self::join(batches, owned, cells.images())
    }

    /// Joins the lists of the batches, of `owned` different particles in total, whose entries refer to `images`.
    pub(crate) fn join(batches: Vec<Batch>, owned: usize, images: &Images) -> Self {
        let mut total = 0;
        let mut place = |batch: &Batch| {
            total += batch.list.len();
            total - batch.list.len()
        };
        let first_places: Vec<usize> = batches.iter().map(&mut place).collect();
        let (ends, lists): (Vec<_>, Vec<_>) = batches.into_iter().map(|batch| (batch.ends, batch.list)).unzip();
        let mut ranges = vec![[0; 2]; owned];
        let by_row = ScatteredWrites::into(&mut ranges);
        ends.into_par_iter().zip(first_places).measured().for_each(|(ends, first)| {
            let mut start = first;
            for (row, end) in ends {
                let range = [start, first + end];
                // SAFETY: each particle is in one batch.
                unsafe { by_row.set(row as usize, range) };
                start = first + end;
            }
        });
        Self { ranges, list: concat(lists), images: images.clone() }
    }

    /// Neighbours of one particle.
    pub fn of(&self, row: usize) -> NeighboursOf<'_> {
        NeighboursOf { list: self.entries(row), images: &self.images }
    }

    /// Entries of one particle's list.
    pub(crate) fn entries(&self, row: usize) -> &[u32] {
        let [start, end] = self.ranges[row];
        &self.list[start..end]
    }

    /// Images to which entries refer.
    pub(crate) fn images(&self) -> &Images {
        &self.images
    }

    /// The neighbours for which `stays` is true, given the rows of a particle and its neighbour.
    #[must_use]
    pub fn retained(&self, stays: impl Fn(usize, usize) -> bool + Sync) -> Self {
        let owned = self.ranges.len();
        let of_batch = |batch: usize| {
            let mut kept = Batch::default();
            for row in batch * BATCH..owned.min((batch + 1) * BATCH) {
                let entries = self.entries(row).iter().copied();
                kept.list.extend(entries.filter(|&entry| stays(row, self.images.neighbour(entry).row as usize)));
                kept.ends.push((row as u32, kept.list.len()));
            }
            kept
        };
        let batches = (0..owned.div_ceil(BATCH)).into_par_iter().map(of_batch).measured().collect();
        Self::join(batches, owned, &self.images)
    }

    /// Number of entries in all lists: twice the number of pairs on one rank.
    pub fn count(&self) -> usize {
        self.list.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pairs;

    #[test]
    fn they_are_the_pairs_seen_from_both_ends() {
        let cell = PeriodicBox::sheared(Vector::new(4.0, 3.0, 5.0), 0.37).unwrap();
        let place = |i: u64| cell.wrap(Vector::new(i as f64 * 2.347, i as f64 * 1.713, i as f64 * 3.219)).0;
        let positions: Vec<Vector> = (0..70).map(place).collect();
        let ids: Vec<u64> = (0..70).collect();
        let pairs = Pairs::find(&cell, &positions, &ids, 70, 1.9);
        let mut expected = vec![Vec::new(); 70];
        for pair in pairs.list() {
            expected[pair.i as usize].push(Neighbour { row: pair.j, steps: pair.steps });
            expected[pair.j as usize].push(Neighbour { row: pair.i, steps: pair.steps.map(|s| -s) });
        }
        let neighbours = Neighbours::find(&cell, &positions, 70, 1.9);
        assert_eq!(neighbours.count(), 2 * pairs.list().len());
        for (row, expected) in expected.iter_mut().enumerate() {
            let mut found: Vec<Neighbour> = neighbours.of(row).iter().collect();
            found.sort_unstable();
            expected.sort_unstable();
            assert_eq!(found, *expected);
        }
        let others = neighbours.retained(|row, other| row % 7 != other % 7);
        for (row, expected) in expected.iter_mut().enumerate() {
            expected.retain(|other| row % 7 != other.row as usize % 7);
            let mut found: Vec<Neighbour> = others.of(row).iter().collect();
            found.sort_unstable();
            assert_eq!(found, *expected);
        }
    }
}
