//! The matrix row by row.

use crate::pairs::matrix::diagonal_block::DiagonalBlock;
use crate::pairs::matrix::lanes::StoredLanes;
use crate::pairs::matrix::sparse::{LaneGroup, MatrixPart, PairMatrix, ROWS, Slice};
use domain::Vector;
use domain::parallel::{FusedLoops, RowLists};
use fcm::PairRows;

/// Numbers of a pair, as [`PairRows`] has them.
const NUMBERS: usize = 9;

/// A pair of a row: the other particle, and the numbers.
type RowPair = (u32, [f64; NUMBERS]);

impl<T: StoredLanes> PairMatrix<T> {
    /// Rows of `count` particles, without first moments at walls. All of them are in the matrix, or none.
    pub fn rows(&self, count: usize) -> PairRows {
        let lists = RowLists::of_blocks(count, ROWS, |first, ends| {
            self.parts.get(first / ROWS).map_or_else(Vec::new, |part| part.list_pairs(ends))
        });
        let (pairs, own) = (lists.items(), |row: usize| self.parts.get(row / ROWS).map(|part| &part.own[row % ROWS]));
        let (mut made, mut of_own, mut loops) = (PairRows::default(), Vec::new(), FusedLoops::default());
        loops.of_rows(&mut made.starts, count + 1, |row| {
            row.checked_sub(1).map_or(0, |row| lists.range(row).end as i32)
        });
        loops.mapped(&mut made.others, pairs, |&(other, _)| other as i32);
        loops.of_rows(&mut made.numbers, NUMBERS * pairs.len(), |at| pairs[at % pairs.len()].1[at / pairs.len()]);
        loops.of_rows(&mut of_own, count, |row| {
            own(row).map_or([0.0; DiagonalBlock::OWN_NUMBERS], DiagonalBlock::own_numbers)
        });
        loops.run();
        PairRows { own: of_own.into_flattened(), ..made }
    }
}

/// Resistance of a pair along its line of centres.
#[derive(Debug, Clone, Copy)]
pub struct AxialPair {
    /// Row of the matrix.
    pub row: usize,
    /// The other particle, which may be a ghost.
    pub other: usize,
    /// Unit vector from the smaller to the larger sphere.
    pub axis: Vector,
    /// Force on the row's sphere against a velocity of the other along the axis.
    pub resistance: f64,
}

impl PairMatrix<f64> {
    /// The pairs of all rows, each in the rows of both of its spheres, in the order in which they are stored.
    pub fn axial_pairs(&self) -> impl Iterator<Item = AxialPair> {
        self.parts.iter().enumerate().flat_map(|(k, part)| part.axial_pairs(k * ROWS))
    }
}

impl MatrixPart<f64> {
    /// Pairs of a block that begins at the row `first`.
    fn axial_pairs(&self, first: usize) -> impl Iterator<Item = AxialPair> {
        let of_group = move |(slice, group): (&Slice, &LaneGroup<f64>)| {
            let of_lane = |(lane, &row): (usize, &u32)| AxialPair {
                row: first + row as usize,
                other: group.others[lane] as usize,
                axis: Vector::from_array(group.axis.map(|component| component[lane])),
                resistance: -(group.ya[lane] + group.axial_excess[lane]),
            };
            slice.rows().iter().enumerate().map(of_lane).collect::<Vec<_>>()
        };
        let groups =
            self.slices().flat_map(|(slice, range)| self.groups[range].iter().map(move |group| (slice, group)));
        groups.flat_map(of_group)
    }
}

impl<T: StoredLanes> MatrixPart<T> {
    /// The pairs of the block, row by row, with the place after the last one of each row.
    fn list_pairs(&self, ends: &mut [usize]) -> Vec<RowPair> {
        let mut rows: Vec<Vec<RowPair>> = vec![Vec::new(); ends.len()];
        for (slice, groups) in self.slices() {
            for group in &self.groups[groups] {
                for (lane, &row) in slice.rows().iter().enumerate() {
                    rows[row as usize].extend(group.pair(lane));
                }
            }
        }
        let mut pairs = Vec::new();
        for (row, end) in rows.iter().zip(ends) {
            pairs.extend_from_slice(row);
            *end = pairs.len();
        }
        pairs
    }
}

impl<T: StoredLanes> LaneGroup<T> {
    /// The pair of a lane; none if the lane is empty, which has no axis.
    fn pair(&self, lane: usize) -> Option<RowPair> {
        let [x, y, z] = self.axis.map(|component| component[lane].wide());
        let of = |list: &[T; 8]| list[lane].wide();
        let [to_other, from_other] = [of(&self.yb[0]), of(&self.yb[1])];
        let [across, along] = [of(&self.ya), of(&self.axial_excess)];
        let numbers = [x, y, z, across, along, of(&self.yc), of(&self.spin_excess), to_other, from_other];
        (x != 0.0 || y != 0.0 || z != 0.0).then_some((self.others[lane], numbers))
    }
}
