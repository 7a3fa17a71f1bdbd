//! Cell list: disks sorted into cells of the sheared lattice.

use crate::disks::for_each_part;
use crate::disks::state::{CHUNK, DiskState, Identity};
use domain::PeriodicBox;
use glam::DVec2;
use std::ops::Range;

/// Data of a disk for the search, next to its neighbours in memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CellEntry {
    pub(super) position: DVec2,
    pub(super) radius: f64,
    pub(super) row: u32,
    /// Rank of its radius among all disks.
    pub(super) rank: u32,
}

impl CellEntry {
    pub(super) fn of(state: &DiskState, row: usize) -> Self {
        let Identity { radius, rank, .. } = state.identities[row];
        Self { position: state.reference(row), radius, row: row as u32, rank }
    }
}

/// Largest number of cells per disk.
const MOST_CELLS: f64 = 64.0;

/// Cells in lattice coordinates `(x - s y, y)`, stored row by row, so that cells adjacent in x
/// are one range of entries.
#[derive(Debug)]
pub(in crate::disks) struct DiskCells {
    counts: [i64; 2],
    starts: Vec<u32>,
    entries: Vec<CellEntry>,
    edges: DVec2,
    strain: f64,
}

impl DiskCells {
    /// Sorts the reference positions of the drift, which are inside the box, into cells of about the given edges.
    pub(super) fn sort(cell: &PeriodicBox, state: &DiskState, about: DVec2) -> Self {
        let edges = cell.edges().truncate();
        let counts = Self::counts(edges, about, state.len());
        let counts = counts.to_array().map(|c| c as i64);
        let none = CellEntry { position: DVec2::ZERO, radius: 0.0, row: 0, rank: 0 };
        let starts = vec![0; (counts[0] * counts[1]) as usize + 1];
        let mut grid = Self { counts, starts, entries: vec![none; state.len()], edges, strain: cell.strain() };
        let mut homes = vec![0_u32; state.len()];
        let mut parts: Vec<_> = homes.chunks_mut(CHUNK).enumerate().collect();
        for_each_part(&mut parts, |(chunk, homes)| {
            for (row, home) in homes.iter_mut().enumerate() {
                *home = grid.home(state.reference(*chunk * CHUNK + row));
            }
        });
        for &home in &homes {
            grid.starts[home as usize + 1] += 1;
        }
        for c in 1..grid.starts.len() {
            grid.starts[c] += grid.starts[c - 1];
        }
        let mut next = grid.starts.clone();
        for (row, &home) in homes.iter().enumerate() {
            let slot = &mut next[home as usize];
            grid.entries[*slot as usize] = CellEntry::of(state, row);
            *slot += 1;
        }
        grid
    }

    /// Numbers of cells of about the given edges along each edge of a box with this number of disks.
    pub(in crate::disks) fn counts(edges: DVec2, about: DVec2, disks: usize) -> DVec2 {
        // For few disks far fewer cells suffice.
        let most = MOST_CELLS * disks.max(64) as f64;
        let wanted = (edges / about).floor().max(DVec2::ONE);
        let fewer = (most / (wanted.x * wanted.y)).min(1.0);
        if fewer < 1.0 { (wanted * fewer.sqrt()).floor().clamp(DVec2::ONE, DVec2::splat(most)) } else { wanted }
    }

    /// The disks in the order of their cells.
    pub(super) fn entries(&self) -> &[CellEntry] {
        &self.entries
    }

    /// The rows in the order of their cells.
    pub(super) fn order(&self) -> Vec<u32> {
        self.entries.iter().map(|e| e.row).collect()
    }

    /// Visits the entries that may be within a distance, less than a cell's edge, of a position, in ranges, each with
    /// the lattice steps to its image.
    pub(super) fn for_each_near(&self, position: DVec2, distance: f64, mut visit: impl FnMut([i32; 2], Range<usize>)) {
        let per_cell = DVec2::new(self.counts[0] as f64, self.counts[1] as f64) / self.edges;
        let xi = position.x - self.strain * position.y;
        // Within this distance, the first lattice coordinate differs by up to sqrt(1 + s^2) times it.
        let spread = distance * (1.0 + self.strain * self.strain).sqrt();
        // Adding one box edge makes the numbers positive, so that the conversion rounds down.
        let [columns, rows] = self.counts;
        let cell = |x: f64, edge: f64, per_cell: f64, count: i64| ((x + edge) * per_cell) as i64 - count;
        let [left, right] = [xi - spread, xi + spread].map(|x| cell(x, self.edges.x, per_cell.x, columns));
        let [low, high] =
            [position.y - distance, position.y + distance].map(|y| cell(y, self.edges.y, per_cell.y, rows));
        for row in low..=high {
            let (up, row) = split(row, rows);
            let mut column = left;
            while column <= right {
                let (along, first) = split(column, columns);
                let last = (first + right - column).min(columns - 1);
                let bounds =
                    [row * columns + first, row * columns + last + 1].map(|c| self.starts[c as usize] as usize);
                visit([along, up], bounds[0]..bounds[1]);
                column += last + 1 - first;
            }
        }
    }

    fn home(&self, position: DVec2) -> u32 {
        let inside = DVec2::new(position.x - self.strain * position.y, position.y) / self.edges;
        let index = |fraction: f64, count: i64| ((fraction * count as f64) as i64).clamp(0, count - 1);
        (index(inside.y, self.counts[1]) * self.counts[0] + index(inside.x, self.counts[0])) as u32
    }
}

/// Splits a cell of the infinite lattice into a lattice step, -1, 0 or 1, and a cell of the box.
fn split(cell: i64, count: i64) -> (i32, i64) {
    if cell < 0 {
        (-1, cell + count)
    } else if cell >= count {
        (1, cell - count)
    } else {
        (0, cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_cell_has_what_round_off_puts_on_the_edge() {
        let edges = DVec2::new(30.0, 20.0);
        let grid = DiskCells { counts: [3, 2], starts: vec![], entries: vec![], edges, strain: 0.0 };
        assert_eq!([DVec2::ZERO, 0.5 * edges, edges].map(|position| grid.home(position)), [0, 4, 5]);
    }
}
