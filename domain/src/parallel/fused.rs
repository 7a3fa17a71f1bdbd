//! Loops over several lists, fused into one parallel loop.

use super::MeasuredLoop;
use rayon::prelude::*;
use std::mem::MaybeUninit;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes of a list that one thread processes at a time, at least: less is not worth the hand-over to another thread.
const PART: usize = 1 << 13;

/// Most parts of a list.
const PARTS: usize = 256;

/// Number of terms that one thread sums; the sums of these blocks are added in their order.
const SUMMED: usize = 1024;

/// Rows that one thread processes at a time of a list of `count`, if a row takes hardly longer than to copy it.
pub(super) fn rows_of_part<T>(count: usize) -> usize {
    (PART / size_of::<T>().max(1)).max(count.div_ceil(PARTS)).max(1)
}

/// Loops over the rows of lists, run as one parallel loop, in which threads take parts of all lists. A loop must not
/// depend on another one. Results are those of serial loops.
///
/// One loop over many lists takes a fraction of the time of many loops, each of which wakes threads and waits for
/// them.
#[derive(Default)]
pub struct FusedLoops<'a> {
    loops: Vec<Box<dyn PartedLoop + 'a>>,
}

/// A loop in parts.
trait PartedLoop: Sync {
    fn parts(&self) -> usize;

    /// Runs a part.
    ///
    /// # Safety
    /// Each part may run once.
    unsafe fn run(&self, part: usize);

    /// Called when all parts have run.
    fn end(&mut self) {}

    /// Bytes that the loop writes.
    fn bytes(&self) -> usize;
}

impl<'a> FusedLoops<'a> {
    /// Runs the loops.
    #[track_caller]
    pub fn run(mut self) {
        let parts_of = |k: usize| (0..self.loops[k].parts()).map(move |part| [k, part]);
        let parts: Vec<[usize; 2]> = (0..self.loops.len()).flat_map(parts_of).collect();
        let bytes = self.loops.iter().map(|of| of.bytes()).sum();
        if !parts.is_empty() {
            // SAFETY: each part is in the list once.
            parts.par_iter().moving(bytes).for_each(|&[k, part]| unsafe { self.loops[k].run(part) });
        }
        self.loops.iter_mut().for_each(|of| of.end());
    }

    /// Makes a list of a value for each of `count` rows, in place of what was in it.
    pub fn of_rows<T: Copy + Send + Sync>(
        &mut self,
        list: &'a mut Vec<T>,
        count: usize,
        value: impl Fn(usize) -> T + Sync + 'a,
    ) {
        self.filled(list, count, move |first, places| {
            places.iter_mut().zip(first..).for_each(|(place, row)| _ = place.write(value(row)));
        });
    }

    /// Makes a list of a value for each element of another list.
    pub fn mapped<T: Sync, U: Copy + Send + Sync>(
        &mut self,
        list: &'a mut Vec<U>,
        of: &'a [T],
        value: impl Fn(&T) -> U + Sync + 'a,
    ) {
        self.filled(list, of.len(), move |first, places| {
            let of = &of[first..first + places.len()];
            places.iter_mut().zip(of).for_each(|(place, element)| _ = place.write(value(element)));
        });
    }

    /// Makes a copy of a list.
    pub fn copied<T: Copy + Send + Sync>(&mut self, list: &'a mut Vec<T>, of: &'a [T]) {
        self.mapped(list, of, |&value| value);
    }

    /// Changes each element of a list by that of another one. The longer list is cut off.
    pub fn change<T: Send, U: Sync>(
        &mut self,
        list: &'a mut [T],
        others: &'a [U],
        change: impl Fn(&mut T, &U) + Sync + 'a,
    ) {
        let count = list.len().min(others.len());
        self.change_parts(&mut list[..count], move |first, part| {
            let others = &others[first..first + part.len()];
            part.iter_mut().zip(others).for_each(|(value, other)| change(value, other));
        });
    }

    /// Changes each element of a list by a function of its row.
    pub fn change_rows<T: Send>(&mut self, list: &'a mut [T], change: impl Fn(usize, &mut T) + Sync + 'a) {
        self.change_parts(list, move |first, part| {
            part.iter_mut().zip(first..).for_each(|(value, row)| change(row, value));
        });
    }

    /// Sets a number to the sum of `count` terms, given the sum of those of a range: in the same order on any number of
    /// threads.
    pub fn sum(&mut self, sum: &'a mut f64, count: usize, of_block: impl Fn(Range<usize>) -> f64 + Sync + 'a) {
        self.reduce(sum, count, of_block, |sums| sums.sum());
    }

    /// Sets a number to the greatest value of a function over a list, at least 0; NaN is ignored.
    pub fn greatest<T: Sync>(&mut self, greatest: &'a mut f64, list: &'a [T], value: impl Fn(&T) -> f64 + Sync + 'a) {
        let of_block = move |rows: Range<usize>| list[rows].iter().map(&value).fold(0.0, f64::max);
        self.reduce(greatest, list.len(), of_block, |values| values.fold(0.0, f64::max));
    }

    fn reduce(
        &mut self,
        result: &'a mut f64,
        count: usize,
        of_block: impl Fn(Range<usize>) -> f64 + Sync + 'a,
        of_blocks: fn(&mut dyn Iterator<Item = f64>) -> f64,
    ) {
        let values = (0..count.div_ceil(SUMMED)).map(|_| AtomicU64::new(0)).collect();
        self.loops.push(Box::new(Reduction { result, values, count, of_block, of_blocks }));
    }

    /// [`Self::sum`] of a function that changes a block of the elements, given its first row.
    pub fn change_and_sum<T: Send>(
        &mut self,
        list: &'a mut [T],
        sum: &'a mut f64,
        of_block: impl Fn(usize, &mut [T]) -> f64 + Sync + 'a,
    ) {
        let places = Places { rows: SUMMED, ..Places::of(list) };
        self.sum(sum, list.len(), move |rows| {
            // SAFETY: each block once, while the list is borrowed.
            let (first, block) = unsafe { places.part(rows.start / SUMMED) };
            of_block(first, block)
        });
    }

    /// Makes a list by a function that writes all elements of the part from a row on.
    fn filled<T: Copy + Send + Sync>(
        &mut self,
        list: &'a mut Vec<T>,
        count: usize,
        fill: impl Fn(usize, &mut [MaybeUninit<T>]) + Sync + 'a,
    ) {
        list.clear();
        list.reserve_exact(count);
        let places = Places::of(&mut list.spare_capacity_mut()[..count]);
        self.loops.push(Box::new(FilledList { list, places, fill }));
    }

    fn change_parts<T: Send>(&mut self, list: &'a mut [T], change: impl Fn(usize, &mut [T]) + Sync + 'a) {
        self.loops.push(Box::new(ChangedList { places: Places::of(list), change }));
    }
}

/// A list that is made by a function.
struct FilledList<'a, T, F> {
    list: &'a mut Vec<T>,
    places: Places<MaybeUninit<T>>,
    fill: F,
}

impl<T: Copy + Send + Sync, F: Fn(usize, &mut [MaybeUninit<T>]) + Sync> PartedLoop for FilledList<'_, T, F> {
    fn parts(&self) -> usize {
        self.places.parts()
    }

    unsafe fn run(&self, part: usize) {
        // SAFETY: each part once, while the list is borrowed.
        let (first, places) = unsafe { self.places.part(part) };
        (self.fill)(first, places);
    }

    fn end(&mut self) {
        // SAFETY: all parts have been filled, and together they are these elements.
        unsafe { self.list.set_len(self.places.count) };
    }

    fn bytes(&self) -> usize {
        2 * self.places.bytes()
    }
}

/// A list that is changed by a function.
struct ChangedList<T, F> {
    places: Places<T>,
    change: F,
}

impl<T: Send, F: Fn(usize, &mut [T]) + Sync> PartedLoop for ChangedList<T, F> {
    fn parts(&self) -> usize {
        self.places.parts()
    }

    unsafe fn run(&self, part: usize) {
        // SAFETY: each part once, while the list is borrowed.
        let (first, list) = unsafe { self.places.part(part) };
        (self.change)(first, list);
    }

    fn bytes(&self) -> usize {
        3 * self.places.bytes()
    }
}

/// A number that follows from those of blocks of rows.
struct Reduction<'a, F> {
    result: &'a mut f64,
    /// Bits of the values of blocks.
    values: Vec<AtomicU64>,
    count: usize,
    of_block: F,
    of_blocks: fn(&mut dyn Iterator<Item = f64>) -> f64,
}

impl<F: Fn(Range<usize>) -> f64 + Sync> PartedLoop for Reduction<'_, F> {
    fn parts(&self) -> usize {
        self.values.len()
    }

    unsafe fn run(&self, part: usize) {
        let value = (self.of_block)(part * SUMMED..self.count.min((part + 1) * SUMMED));
        self.values[part].store(value.to_bits(), Ordering::Relaxed);
    }

    fn end(&mut self) {
        *self.result = (self.of_blocks)(&mut self.values.iter_mut().map(|value| f64::from_bits(*value.get_mut())));
    }

    fn bytes(&self) -> usize {
        0
    }
}

/// Elements of a list that stays borrowed, in parts.
struct Places<T> {
    first: *mut T,
    count: usize,
    /// Rows of a part.
    rows: usize,
}

// SAFETY: each part is given out once, to one thread.
unsafe impl<T: Send> Send for Places<T> {}
// SAFETY: as above.
unsafe impl<T: Send> Sync for Places<T> {}

impl<T> Places<T> {
    fn of(list: &mut [T]) -> Self {
        Self { first: list.as_mut_ptr(), count: list.len(), rows: rows_of_part::<T>(list.len()) }
    }

    fn parts(&self) -> usize {
        self.count.div_ceil(self.rows)
    }

    fn bytes(&self) -> usize {
        self.count * size_of::<T>()
    }

    /// The first row of a part, and the part.
    ///
    /// # Safety
    /// Each part may be taken once, as long as the list is borrowed.
    #[allow(clippy::mut_from_ref, reason = "parts are disjoint")]
    unsafe fn part(&self, part: usize) -> (usize, &mut [T]) {
        let first = part * self.rows;
        let length = self.rows.min(self.count - first);
        // SAFETY: within the list, and disjoint from other parts.
        (first, unsafe { std::slice::from_raw_parts_mut(self.first.add(first), length) })
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
        fn fused_loops_do_what_serial_loops_do(
            numbers in proptest::collection::vec(any::<u32>(), 0..3 * PART), shorter in 0_usize..3 * PART,
        ) {
            let shorter = &numbers[..shorter.min(numbers.len())];
            let scaled: Vec<f64> = numbers.iter().map(|&number| 0.1 * f64::from(number)).collect();
            let blocks = scaled.chunks(SUMMED).map(|block| block.iter().sum::<f64>());
            let expected = blocks.sum::<f64>().to_bits();
            on_threads(|_| {
                let (mut made, mut copied, mut doubled) = (vec![3.0; 7], Vec::new(), Vec::new());
                let (mut replaced, mut sum, mut again) = (vec![0.0; scaled.len()], f64::NAN, f64::NAN);
                let mut most = f64::NAN;
                let (mut changed, mut by_row) = (numbers.clone(), numbers.clone());
                let mut loops = FusedLoops::default();
                loops.of_rows(&mut made, scaled.len(), |row| 0.1 * f64::from(numbers[row]));
                loops.copied(&mut copied, shorter);
                loops.mapped(&mut doubled, &numbers, |&number| 2 * u64::from(number));
                loops.change(&mut changed, shorter, |value, &other| *value = value.wrapping_add(other));
                loops.change_rows(&mut by_row, |row, value| *value ^= row as u32);
                loops.sum(&mut sum, scaled.len(), |rows| scaled[rows].iter().sum());
                loops.change_and_sum(&mut replaced, &mut again, |first, block| {
                    block.copy_from_slice(&scaled[first..first + block.len()]);
                    block.iter().sum()
                });
                loops.greatest(&mut most, &scaled, |&value| if value > 1e8 { f64::NAN } else { value });
                loops.run();
                let expected_most = scaled.iter().copied().filter(|&value| value <= 1e8).fold(0.0, f64::max);
                assert_eq!(most.to_bits(), expected_most.to_bits());
                assert!(made == scaled && copied == shorter && replaced == scaled);
                assert_eq!([sum, again].map(f64::to_bits), [expected; 2]);
                assert!(doubled.iter().zip(&numbers).all(|(&twice, &once)| twice == 2 * u64::from(once)));
                assert_eq!(doubled.len(), numbers.len());
                let other = |row: usize| shorter.get(row).copied().unwrap_or(0);
                let is_changed = |row: usize| changed[row] == numbers[row].wrapping_add(other(row));
                assert!((0..numbers.len()).all(|row| is_changed(row) && by_row[row] == numbers[row] ^ row as u32));
            });
        }
    }

    /// Loops are one: it has the parts of all lists.
    #[test]
    fn many_lists_are_one_loop() {
        let list = vec![1.0; 10 * PART / size_of::<f64>()];
        let run = || {
            let mut copies = [const { Vec::new() }; 3];
            let mut loops = FusedLoops::default();
            for copy in &mut copies {
                loops.copied(copy, &list);
            }
            loops.run();
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let ((), profile) = pool.install(|| super::super::measure(super::super::wall_clock, run));
        let of_loops = &profile.stages()[0].loops;
        assert_eq!(of_loops.iter().map(|of| [of.runs, of.tasks]).collect::<Vec<_>>(), [[1, 30]]);
    }
}
