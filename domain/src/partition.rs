//! Domain decomposition: the share of space that each rank owns.

use crate::{Comm, PeriodicBox, Vector, block, block_of};
use std::ops::Range;

/// Place of a rank in the table of ranks and the grid lines that it owns, as in [`Partition`]; the rank need not
/// exist.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    table: [usize; 2],
    index: [usize; 2],
    lines: [usize; 2],
}

impl Place {
    /// Place of a rank among `ranks` that divide the grid lines as [`Partition::new`] does.
    pub fn of(ranks: usize, rank: usize, lines: [usize; 2]) -> Self {
        Self::in_table(best_table(ranks, lines), rank, lines)
    }

    fn in_table(table: [usize; 2], rank: usize, lines: [usize; 2]) -> Self {
        Self { table, index: [rank / table[1], rank % table[1]], lines }
    }

    /// Rows and columns of the table of ranks.
    pub fn table(&self) -> [usize; 2] {
        self.table
    }

    /// The rank's row and column in the table.
    pub fn index(&self) -> [usize; 2] {
        self.index
    }

    /// Grid lines along y and along z.
    pub fn lines(&self) -> [usize; 2] {
        self.lines
    }

    /// The rank's lines along y and along z.
    pub fn owned(&self) -> [Range<usize>; 2] {
        std::array::from_fn(|d| block(self.lines[d], self.table[d], self.index[d]))
    }

    /// Rank of the table whose pencil holds a position inside the box.
    pub fn owner(&self, cell: &PeriodicBox, position: Vector) -> usize {
        let Self { table, lines, .. } = self;
        let line = |d: usize, fraction: f64| ((fraction * lines[d] as f64) as usize).min(lines[d] - 1);
        let fractions = cell.fractional_coordinates(position);
        let row = block_of(lines[0], table[0], line(0, fractions.y));
        let column = block_of(lines[1], table[1], line(1, fractions.z));
        row * table[1] + column
    }
}

/// Slabs along z if each rank gets at least four lines, which saves a transposition, else pencils.
fn best_table(ranks: usize, lines: [usize; 2]) -> [usize; 2] {
    let slabs = ranks <= 4 || ranks * 4 <= lines[1];
    let rows = if slabs { 1 } else { (1..=ranks.isqrt()).rev().find(|r| ranks.is_multiple_of(*r)).unwrap_or(1) };
    [rows, ranks / rows]
}

/// Domain decomposition: the ranks form a table of `rows x columns`, rank `r` in row `r / columns`. Real space is
/// divided into pencils along x: the row determines the lines along y that a rank owns, the column the lines along z.
/// A particle is owned by the rank whose pencil contains it.
#[derive(Clone)]
pub struct Partition {
    all: Comm,
    row: Comm,
    column: Comm,
    place: Place,
}

impl Partition {
    /// Divides `lines = [along y, along z]` grid lines among the ranks: in slabs along z if each rank gets at least
    /// four lines, which saves a transposition, else in pencils.
    pub fn new(comm: &Comm, lines: [usize; 2]) -> Self {
        Self::with_table(comm, lines, best_table(comm.size(), lines))
    }

    /// Divides grid lines among a table of ranks chosen by the caller.
    ///
    /// # Panics
    /// If the table does not have as many places as there are ranks.
    pub fn with_table(comm: &Comm, lines: [usize; 2], table: [usize; 2]) -> Self {
        assert_eq!(table[0] * table[1], comm.size(), "the table of ranks has a place for each rank");
        let place = Place::in_table(table, comm.rank(), lines);
        let [row, column] = place.index;
        Self { all: comm.clone(), row: comm.split(row), column: comm.split(column), place }
    }

    /// All ranks.
    pub fn comm(&self) -> &Comm {
        &self.all
    }

    /// Ranks of this rank's row, which share its lines along y and divide those along z.
    pub fn row(&self) -> &Comm {
        &self.row
    }

    /// Ranks of this rank's column, which share its lines along z and divide those along y.
    pub fn column(&self) -> &Comm {
        &self.column
    }

    /// Place of this rank in the table.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// Grid lines along y and along z.
    pub fn lines(&self) -> [usize; 2] {
        self.place.lines
    }

    /// Rows and columns of the table of ranks.
    pub fn table(&self) -> [usize; 2] {
        self.place.table
    }

    /// This rank's lines along y and along z.
    pub fn owned(&self) -> [Range<usize>; 2] {
        self.place.owned()
    }

    /// Another rank's lines along y and along z.
    pub fn owned_by(&self, rank: usize) -> [Range<usize>; 2] {
        Place::in_table(self.place.table, rank, self.place.lines).owned()
    }

    /// Rank whose pencil holds a position inside the box.
    pub fn owner(&self, cell: &PeriodicBox, position: Vector) -> usize {
        self.place.owner(cell, position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn blocks_cover_everything_once(count in 1_usize..200, parts in 1_usize..50) {
            let mut next = 0;
            for index in 0..parts {
                let range = block(count, parts, index);
                prop_assert_eq!(range.start, next);
                next = range.end;
                for element in range {
                    prop_assert_eq!(block_of(count, parts, element), index);
                }
            }
            prop_assert_eq!(next, count);
        }
    }

    #[test]
    fn every_position_has_its_owner() {
        for ranks in [1, 2, 3, 4, 7, 13, 16, 64] {
            Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [6, 5]);
                let cell = PeriodicBox::new(Vector::new(1.0, 6.0, 5.0)).unwrap();
                for (y, z) in (0..6).flat_map(|y| (0..5).map(move |z| (y, z))) {
                    let owner = partition.owner(&cell, Vector::new(0.5, y as f64 + 0.5, z as f64 + 0.5));
                    let [ys, zs] = partition.owned_by(owner);
                    assert!(ys.contains(&y) && zs.contains(&z));
                }
            });
        }
    }

    #[test]
    fn rows_and_columns_meet_in_one_rank() {
        Comm::threads(6, |comm| {
            let partition = Partition::with_table(&comm, [12, 12], [2, 3]);
            assert_eq!((partition.row().size(), partition.column().size()), (3, 2));
            assert_eq!(comm.rank(), partition.column().rank() * 3 + partition.row().rank());
        });
    }
}
