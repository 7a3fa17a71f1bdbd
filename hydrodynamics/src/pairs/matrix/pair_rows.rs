//! The matrix row by row, for a device.

use crate::pairs::matrix::diagonal_block::DiagonalBlock;
use crate::pairs::matrix::lanes::StoredLanes;
use crate::pairs::matrix::sparse::{LaneGroup, MatrixPart, PairMatrix, ROWS};
use fcm::PairRows;

/// Numbers of a pair, as [`PairRows`] has them.
const NUMBERS: usize = 9;

/// A pair of a row: the other particle, and the numbers.
type RowPair = (u32, [f64; NUMBERS]);

impl<T: StoredLanes> PairMatrix<T> {
    /// Rows of `count` particles. All of them are in the matrix, or none.
    pub fn rows(&self, count: usize) -> PairRows {
        let mut pairs: Vec<Vec<RowPair>> = vec![Vec::new(); count];
        for (part, pairs) in self.parts.iter().zip(pairs.chunks_mut(ROWS)) {
            part.list_pairs(pairs);
        }
        let ends = pairs.iter().scan(0, |end, row| {
            *end += row.len() as i32;
            Some(*end)
        });
        let starts = std::iter::once(0).chain(ends).collect();
        let own = self.parts.iter().flat_map(|part| &part.own).chain(&[]).flat_map(DiagonalBlock::own_numbers);
        let mut own: Vec<f64> = own.collect();
        own.resize(count * DiagonalBlock::OWN_NUMBERS, 0.0);
        let numbers = (0..NUMBERS).flat_map(|k| pairs.iter().flatten().map(move |(_, numbers)| numbers[k])).collect();
        PairRows { starts, others: pairs.iter().flatten().map(|&(other, _)| other as i32).collect(), numbers, own }
    }
}

impl<T: StoredLanes> MatrixPart<T> {
    /// Lists the pairs of each row of the block.
    fn list_pairs(&self, rows: &mut [Vec<RowPair>]) {
        for (slice, groups) in self.slices() {
            for group in &self.groups[groups] {
                for (lane, &row) in slice.rows().iter().enumerate() {
                    rows[row as usize].extend(group.pair(lane));
                }
            }
        }
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
