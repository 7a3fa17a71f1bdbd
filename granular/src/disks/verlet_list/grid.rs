//! Cell list: disks sorted into cells of the sheared lattice.

use crate::disks::state::{DiskState, Identity};
use domain::PeriodicBox;
use domain::parallel::{SortedRows, mapped, of_rows};
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

/// Width and height of a cell in units of the mean diameter: few rows to search, and few disks in each.
const CELL: DVec2 = DVec2::new(0.5, 2.0);
/// Largest number of cells per disk.
const MOST_CELLS: f64 = 64.0;

/// Cells in lattice coordinates `(x - s y, y)`, stored row by row, so that cells adjacent in x
/// are one range of entries.
#[derive(Debug)]
pub(in crate::disks) struct DiskCells {
    counts: [i64; 2],
    sorted: SortedRows,
    entries: Vec<CellEntry>,
    edges: DVec2,
    strain: f64,
}

impl DiskCells {
    /// Sorts the reference positions of the drift, which are inside the box, into cells.
    pub(super) fn sort(cell: &PeriodicBox, state: &DiskState) -> Self {
        let (edges, disks) = (cell.edges().truncate(), state.len() as f64);
        let mean_radius = state.identities.iter().map(|disk| disk.radius).sum::<f64>() / disks;
        let counts = Self::counts(edges, mean_radius, disks).to_array().map(|c| c as i64);
        let mut grid =
            Self { counts, sorted: SortedRows::default(), entries: Vec::new(), edges, strain: cell.strain() };
        let homes = of_rows(state.len(), |row| grid.home(state.reference(row)));
        grid.sorted = SortedRows::by_key(&homes, (counts[0] * counts[1]) as usize);
        grid.entries = mapped(grid.rows(), |&row| CellEntry::of(state, row as usize));
        grid
    }

    /// Numbers of cells along each edge of a box with this number of disks.
    pub(in crate::disks) fn counts(edges: DVec2, mean_radius: f64, disks: f64) -> DVec2 {
        // For few disks far fewer cells suffice.
        let most = MOST_CELLS * disks.max(64.0);
        let wanted = (edges / (CELL * 2.0 * mean_radius)).floor().max(DVec2::ONE);
        let fewer = (most / (wanted.x * wanted.y)).min(1.0);
        if fewer < 1.0 { (wanted * fewer.sqrt()).floor().clamp(DVec2::ONE, DVec2::splat(most)) } else { wanted }
    }

    /// The disks in the order of their cells.
    pub(super) fn entries(&self) -> &[CellEntry] {
        &self.entries
    }

    /// The rows in the order of their cells.
    pub(super) fn rows(&self) -> &[u32] {
        self.sorted.rows()
    }

    /// Visits the entries that may be within a distance, less than a cell's edge, of a position, in ranges, each with
    /// the lattice steps to its image.
    #[inline(always)]
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
                let bounds = [row * columns + first, row * columns + last + 1]
                    .map(|c| self.sorted.starts()[c as usize] as usize);
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
        let grid = DiskCells { counts: [3, 2], sorted: SortedRows::default(), entries: vec![], edges, strain: 0.0 };
        assert_eq!([DVec2::ZERO, 0.5 * edges, edges].map(|position| grid.home(position)), [0, 4, 5]);
    }
}
