//! Rows sorted by small keys.

use super::MeasuredLoop;
use super::lists::{ScatteredWrites, split};
use rayon::prelude::*;

/// Rows in the order of their keys, and among equal keys in their own order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SortedRows {
    /// Place of the first row of each key, and their number in the end.
    starts: Vec<u32>,
    rows: Vec<u32>,
}

/// Most ranges of keys, each of which one thread sorts, and rows of a range in the mean, at least.
const RANGES: usize = 256;
const IN_RANGE: usize = 64;

/// Rows that one thread counts at a time, at least, and most such tiles.
const TILE: usize = 512;
const TILES: usize = 128;

/// A row with its key.
type Keyed = [u32; 2];

/// Checks that the numbers of so many rows have 32 bits; the largest such number is left to stand for no row.
///
/// # Panics
///
/// If there are more rows.
#[track_caller]
pub fn check_row_numbers(rows: usize) {
    let fits = u32::try_from(rows).is_ok();
    assert!(fits, "a list of a rank has {rows} rows, whose numbers need more than 32 bits: take more ranks");
}

impl SortedRows {
    /// Sorts the rows of a list of keys, all below `count`.
    ///
    /// # Panics
    ///
    /// If a key is not below `count`, or if row numbers need more than 32 bits.
    #[track_caller]
    pub fn by_key(keys: &[u32], count: usize) -> Self {
        check_row_numbers(keys.len());
        let parts = (keys.len() / IN_RANGE).clamp(1, RANGES);
        let bits = count.div_ceil(parts).next_power_of_two().trailing_zeros();
        let ranges = count.div_ceil(1 << bits);
        let (keyed, ends) = if ranges > 1 { by_range(keys, bits, ranges) } else { in_order(keys) };
        let mut sorted = Self { starts: vec![0; count + 1], rows: vec![0; keys.len()] };
        sorted.starts[count] = keys.len() as u32;
        let length = |range: usize| ends[range] - range.checked_sub(1).map_or(0, |before| ends[before]);
        let rows = split(&mut sorted.rows, (0..ranges).map(length));
        let starts = sorted.starts[..count].par_chunks_mut(1 << bits);
        starts.zip(rows).enumerate().measured().for_each(|(range, (starts, rows))| {
            let first = ends[range] - rows.len();
            sort_range(&keyed[first..ends[range]], [range << bits, first], starts, rows);
        });
        sorted
    }

    /// Place of the first row of each key in [`Self::rows`], and at the end the number of rows.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// Rows of a key.
    pub fn of(&self, key: usize) -> &[u32] {
        &self.rows[self.starts[key] as usize..self.starts[key + 1] as usize]
    }

    /// Rows in the order of their keys.
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }
}

/// Rows with keys as they are, in one range.
fn in_order(keys: &[u32]) -> (Vec<Keyed>, Vec<usize>) {
    (keys.iter().zip(0..).map(|(&key, row)| [key, row]).collect(), vec![keys.len()])
}

/// Rows sorted by the ranges of `2^bits` keys in which theirs are, and the end of each range.
fn by_range(keys: &[u32], bits: u32, ranges: usize) -> (Vec<Keyed>, Vec<usize>) {
    let tile = TILE.max(keys.len().div_ceil(TILES));
    let of = |key: u32| (key >> bits) as usize;
    let counted = keys.par_chunks(tile).map(|keys| {
        let mut counts = vec![0_u32; ranges];
        for &key in keys {
            counts[of(key)] += 1;
        }
        counts
    });
    let mut places: Vec<Vec<u32>> = counted.measured().collect();
    let (mut sum, mut ends) = (0, Vec::with_capacity(ranges));
    for range in 0..ranges {
        for counts in &mut places {
            (counts[range], sum) = (sum, sum + counts[range]);
        }
        ends.push(sum as usize);
    }
    let mut sorted = vec![[0; 2]; keys.len()];
    let scatter = ScatteredWrites::into(&mut sorted);
    keys.par_chunks(tile).zip(places).enumerate().measured().for_each(|(k, (keys, mut places))| {
        for (&key, row) in keys.iter().zip((k * tile) as u32..) {
            let place = &mut places[of(key)];
            // SAFETY: tiles and ranges have places of their own, as many as there are rows of the range in the tile.
            unsafe { scatter.set(*place as usize, [key, row]) };
            *place += 1;
        }
    });
    (sorted, ends)
}

/// Sorts the rows of a range of keys from the key and the place `first`.
fn sort_range(keyed: &[Keyed], [key, place]: [usize; 2], starts: &mut [u32], rows: &mut [u32]) {
    for &[of, _] in keyed {
        starts[of as usize - key] += 1;
    }
    let mut sum = 0;
    for start in &mut *starts {
        (*start, sum) = (sum, sum + *start);
    }
    for &[of, row] in keyed {
        let next = &mut starts[of as usize - key];
        rows[*next as usize] = row;
        *next += 1;
    }
    // Each start has become the end of its key, which is the start of the next.
    let mut before = 0;
    for start in starts {
        (*start, before) = (place as u32 + before, *start);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::on_threads;
    use super::*;
    use proptest::prelude::*;

    /// Rows sorted by a stable sort, and the number of rows with smaller keys.
    fn by_stable_sort(keys: &[u32], count: usize) -> SortedRows {
        let mut rows: Vec<u32> = (0..keys.len() as u32).collect();
        rows.sort_by_key(|&row| keys[row as usize]);
        let start = |key: usize| rows.partition_point(|&row| (keys[row as usize] as usize) < key) as u32;
        SortedRows { starts: (0..=count).map(start).collect(), rows }
    }

    #[test]
    fn four_billion_rows_have_numbers() {
        check_row_numbers(u32::MAX as usize);
    }

    #[test]
    #[should_panic(expected = "4294967296 rows, whose numbers need more than 32 bits: take more ranks")]
    fn more_rows_are_refused() {
        check_row_numbers(1 << 32);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        #[test]
        fn rows_are_those_of_a_stable_sort(
            numbers in proptest::collection::vec(any::<u32>(), 0..3 * TILE), count in 1_usize..5000, few in 1_u32..9,
        ) {
            for count in [count, 1, RANGES, 2 * RANGES + 1] {
                // Every key, and few of them.
                for most in [count as u32, few.min(count as u32)] {
                    let keys: Vec<u32> = numbers.iter().map(|number| number % most).collect();
                    let expected = by_stable_sort(&keys, count);
                    on_threads(|threads| assert!(SortedRows::by_key(&keys, count) == expected, "{threads} threads"));
                }
            }
        }
    }

    #[test]
    fn nothing_is_sorted_without_keys() {
        assert_eq!(SortedRows::by_key(&[], 0), SortedRows { starts: vec![0], rows: Vec::new() });
    }
}
