//! Who is near each particle.

use crate::cells::Cells;
use crate::{PeriodicBox, Vector};
use rayon::prelude::*;

/// A particle near another: its row among those present, and the lattice steps to the image of it that is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Neighbour {
    /// Row of the neighbour.
    pub row: u32,
    /// Lattice steps added to the neighbour's position.
    pub steps: [i8; 3],
}

/// Particles searched for in one go by one thread.
const BATCH: usize = 256;

/// The neighbours within a cutoff of each particle that this rank owns: a pair stands in the lists of both, so that
/// each list can be worked through by itself.
#[derive(Debug, Clone, Default)]
pub struct Neighbours {
    starts: Vec<usize>,
    list: Vec<Neighbour>,
}

impl Neighbours {
    /// Finds the neighbours, among all particles present, of the first `owned` of them.
    pub fn find(cell: &PeriodicBox, positions: &[Vector], owned: usize, cutoff: f64) -> Self {
        if owned == 0 {
            return Self { starts: vec![0], list: Vec::new() };
        }
        let cells = Cells::sort(cell, positions, cutoff);
        let batches: Vec<(Vec<usize>, Vec<Neighbour>)> = (0..owned.div_ceil(BATCH))
            .into_par_iter()
            .map(|batch| {
                let (mut ends, mut list) = (Vec::with_capacity(BATCH), Vec::with_capacity(BATCH * 16));
                let mut near = Vec::new();
                for i in batch * BATCH..owned.min((batch + 1) * BATCH) {
                    let centre = (positions[i], i as u32);
                    cells.for_each_run(cell, positions[i], |run| {
                        near.clear();
                        run.append_near(centre, cutoff, &mut near);
                        let steps = run.steps;
                        list.extend(near.iter().map(|&row| Neighbour { row, steps }));
                    });
                    ends.push(list.len());
                }
                (ends, list)
            })
            .collect();
        let mut starts = Vec::with_capacity(owned + 1);
        starts.push(0);
        let mut list = Vec::with_capacity(batches.iter().map(|b| b.1.len()).sum());
        for (ends, part) in batches {
            starts.extend(ends.iter().map(|end| list.len() + end));
            list.extend_from_slice(&part);
        }
        Self { starts, list }
    }

    /// The neighbours of one particle.
    pub fn of(&self, row: usize) -> &[Neighbour] {
        &self.list[self.starts[row]..self.starts[row + 1]]
    }

    /// All entries of all lists: twice the number of pairs on one rank.
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
            let mut found = neighbours.of(row).to_vec();
            found.sort_unstable();
            expected.sort_unstable();
            assert_eq!(found, *expected);
        }
    }
}
