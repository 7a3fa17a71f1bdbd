//! Lists of items, one a row, in one list.

use super::FusedLoops;
use super::lists::{change_rows, concat, in_blocks};
use std::ops::Range;

/// Rows whose lists one thread makes at a time, at least, if a row takes some hundred nanoseconds, and most such
/// batches.
const BATCH: usize = 64;
const BATCHES: usize = 256;

/// A list of items for each row, such as the contacts of each particle. All items are in one list, row by row, so that
/// many short lists are one allocation and loops over the items are divided among threads evenly.
///
/// ```
/// use domain::parallel::RowLists;
///
/// let lists = RowLists::of_rows(4, |row, list| list.extend(0..row));
/// assert_eq!((lists.of(0), lists.of(3), lists.range(3)), (&[][..], &[0, 1, 2][..], 3..6));
/// assert_eq!(lists.items(), [0, 0, 1, 0, 1, 2]);
/// assert_eq!(lists, [vec![], vec![0], vec![0, 1], vec![0, 1, 2]].into_iter().collect());
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowLists<T> {
    /// Place after the last item of each row.
    ends: Vec<usize>,
    items: Vec<T>,
}

impl<T> RowLists<T> {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.ends.len()
    }

    /// Places of a row's items in [`Self::items`]; empty for rows beyond the last.
    pub fn range(&self, row: usize) -> Range<usize> {
        let end = |row: usize| self.ends.get(row).copied();
        end(row).map_or(0..0, |last| row.checked_sub(1).and_then(end).unwrap_or(0)..last)
    }

    /// Items of a row; none for rows beyond the last.
    pub fn of(&self, row: usize) -> &[T] {
        &self.items[self.range(row)]
    }

    /// Items of each row.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[T]> {
        (0..self.rows()).map(|row| self.of(row))
    }

    /// All items, row by row.
    pub fn items(&self) -> &[T] {
        &self.items
    }

    /// All items, row by row.
    pub fn into_items(self) -> Vec<T> {
        self.items
    }
}

impl<T: Copy + Send + Sync> RowLists<T> {
    /// Lists of a number of rows, made in parallel by a function that appends the items of a row to a list, which has
    /// those of other rows before. They are the same on any number of threads.
    #[track_caller]
    pub fn of_rows(count: usize, append: impl Fn(usize, &mut Vec<T>) + Sync) -> Self {
        Self::of_blocks(count, BATCH.max(count.div_ceil(BATCHES)), |first, ends| {
            let mut items = Vec::new();
            for (row, end) in (first..).zip(ends) {
                append(row, &mut items);
                *end = items.len();
            }
            items
        })
    }

    /// Lists made in parallel for blocks of rows, by a function that returns the items of a block, row by row, and
    /// notes for each row the place after its last item there. It is given the first row of the block.
    #[track_caller]
    pub fn of_blocks(count: usize, rows: usize, make: impl Fn(usize, &mut [usize]) -> Vec<T> + Sync) -> Self {
        let (mut ends, blocks) = in_blocks(count, rows, make);
        let mut firsts = Vec::with_capacity(blocks.len());
        let mut total = 0;
        for block in &blocks {
            firsts.push(total);
            total += block.len();
        }
        change_rows(&mut ends, |row, end| *end += firsts[row / rows]);
        Self { ends, items: concat(blocks) }
    }

    /// Lists of the values of a function, one for each item.
    #[must_use]
    #[track_caller]
    pub fn mapped<U: Copy + Send + Sync>(&self, value: impl Fn(&T) -> U + Sync) -> RowLists<U> {
        let (mut ends, mut items) = (Vec::new(), Vec::new());
        let mut loops = FusedLoops::default();
        loops.copied(&mut ends, &self.ends);
        loops.mapped(&mut items, &self.items, value);
        loops.run();
        RowLists { ends, items }
    }
}

impl<T> Default for RowLists<T> {
    /// No rows.
    fn default() -> Self {
        Self { ends: Vec::new(), items: Vec::new() }
    }
}

impl<T, L: IntoIterator<Item = T>> FromIterator<L> for RowLists<T> {
    /// The lists of consecutive rows.
    fn from_iter<I: IntoIterator<Item = L>>(lists: I) -> Self {
        let mut made = Self::default();
        for list in lists {
            made.items.extend(list);
            made.ends.push(made.items.len());
        }
        made
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::on_threads;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        #[test]
        fn lists_are_those_of_a_loop(lengths in proptest::collection::vec(0_usize..4, 0..3 * BATCH * BATCHES)) {
            let list = |row: usize| (0..lengths[row]).map(move |k| 10 * row + k);
            let expected: RowLists<usize> = (0..lengths.len()).map(list).collect();
            on_threads(|_| {
                let lists = RowLists::of_rows(lengths.len(), |row, items| items.extend(list(row)));
                assert!(lists == expected && lists.rows() == lengths.len());
                assert!(lists.iter().enumerate().all(|(row, items)| items.iter().copied().eq(list(row))));
                assert!(lists.items().iter().copied().eq((0..lengths.len()).flat_map(list)));
                let tripled = lists.mapped(|item| 3 * item);
                assert!((0..lengths.len()).all(|row| tripled.of(row).iter().copied().eq(list(row).map(|k| 3 * k))));
                assert_eq!(tripled.into_items().len(), lengths.iter().sum::<usize>());
            });
        }
    }

    #[test]
    fn rows_may_have_no_items() {
        for count in [0, 1, BATCH, BATCH + 1, 3 * BATCH] {
            let lists = RowLists::of_rows(count, |row, items: &mut Vec<usize>| {
                items.extend((row + 1 == count).then_some(row));
            });
            assert_eq!((lists.rows(), lists.items().len()), (count, count.min(1)));
            assert!((0..count).all(|row| lists.of(row).len() == usize::from(row + 1 == count)));
            assert!(lists.of(count).is_empty() && lists.of(usize::MAX).is_empty());
        }
        assert_eq!(RowLists::<u8>::of_rows(0, |_, _| ()), RowLists::default());
    }
}
