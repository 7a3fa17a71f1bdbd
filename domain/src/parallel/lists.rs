//! Lists that are made, compared and joined by all threads. Each is the one that a serial loop makes.

use super::MeasuredLoop;
use super::fused::rows_of_part;
use rayon::prelude::*;
use std::marker::PhantomData;
use std::mem::MaybeUninit;

/// Rows that one thread processes at a time, at least, if a row takes tens of nanoseconds.
const BATCH: usize = 256;

/// Parallel loop over a number of rows.
pub fn rows(count: usize) -> impl IndexedParallelIterator<Item = usize> {
    (0..count).into_par_iter().with_min_len(BATCH)
}

/// A value for each row.
#[track_caller]
pub fn of_rows<T: Send>(count: usize, value: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    let mut list = Vec::with_capacity(count);
    let parts = list.spare_capacity_mut()[..count].par_chunks_mut(BATCH).enumerate();
    parts.measured().for_each(|(k, part)| {
        part.iter_mut().zip(k * BATCH..).for_each(|(place, row)| _ = place.write(value(row)));
    });
    // SAFETY: all parts have been written, and together they are `count` elements.
    unsafe { list.set_len(count) };
    list
}

/// A value for each element of a list.
#[track_caller]
pub fn mapped<T: Sync, U: Send>(list: &[T], value: impl Fn(&T) -> U + Sync + Send) -> Vec<U> {
    let mut values = Vec::with_capacity(list.len());
    let rows = rows_of_part::<U>(list.len());
    let parts = values.spare_capacity_mut()[..list.len()].par_chunks_mut(rows);
    parts.zip(list.par_chunks(rows)).measured().for_each(|(part, elements)| {
        part.iter_mut().zip(elements).for_each(|(place, element)| _ = place.write(value(element)));
    });
    // SAFETY: all parts have been written, and together they are as long as the list.
    unsafe { values.set_len(list.len()) };
    values
}

/// A value for each element of a list, which the function may change, given its row.
#[track_caller]
pub fn mapped_mut<T: Send, U: Send>(list: &mut [T], value: impl Fn(usize, &mut T) -> U + Sync) -> Vec<U> {
    let (count, rows) = (list.len(), rows_of_part::<U>(list.len()));
    let mut values = Vec::with_capacity(count);
    let parts = values.spare_capacity_mut()[..count].par_chunks_mut(rows).zip(list.par_chunks_mut(rows)).enumerate();
    parts.measured().for_each(|(k, (part, elements))| {
        let places = part.iter_mut().zip(elements).zip(k * rows..);
        places.for_each(|((place, element), row)| _ = place.write(value(row, element)));
    });
    // SAFETY: all parts have been written, and together they are as long as the list.
    unsafe { values.set_len(count) };
    values
}

/// A list made in blocks of rows, each of default values before a function changes it, given its first row. Also
/// returns the values of the function, block by block.
#[track_caller]
pub fn in_blocks<T: Copy + Default + Send, U: Send>(
    count: usize,
    rows: usize,
    make: impl Fn(usize, &mut [T]) -> U + Sync,
) -> (Vec<T>, Vec<U>) {
    let mut list = Vec::with_capacity(count);
    let blocks = list.spare_capacity_mut()[..count].par_chunks_mut(rows).enumerate();
    let of_block = |(k, places): (usize, &mut [MaybeUninit<T>])| {
        places.fill(MaybeUninit::new(T::default()));
        // SAFETY: all elements have been written.
        make(k * rows, unsafe { &mut *(std::ptr::from_mut(places) as *mut [T]) })
    };
    let values = blocks.map(of_block).measured().collect();
    // SAFETY: all blocks have been written, and together they are `count` elements.
    unsafe { list.set_len(count) };
    (list, values)
}

/// A copy of a list.
#[track_caller]
pub fn copied<T: Copy + Send + Sync>(list: &[T]) -> Vec<T> {
    mapped(list, |&value| value)
}

/// Changes each element of a list by that of another one. The longer list is cut off.
#[track_caller]
pub fn change<T: Send, U: Sync>(list: &mut [T], others: &[U], change: impl Fn(&mut T, &U) + Sync) {
    let rows = rows_of_part::<T>(list.len());
    list.par_chunks_mut(rows).zip(others.par_chunks(rows)).measured().for_each(|(list, others)| {
        list.iter_mut().zip(others).for_each(|(value, other)| change(value, other));
    });
}

/// Changes each element of a list by a function of its row.
#[track_caller]
pub fn change_rows<T: Send>(list: &mut [T], change: impl Fn(usize, &mut T) + Sync) {
    let rows = rows_of_part::<T>(list.len());
    list.par_chunks_mut(rows).enumerate().measured().for_each(|(k, list)| {
        list.iter_mut().zip(k * rows..).for_each(|(value, row)| change(row, value));
    });
}

/// Sets a list to another of the same length.
///
/// # Panics
///
/// If the lengths differ.
#[track_caller]
pub fn overwrite<T: Copy + Send + Sync>(list: &mut [T], others: &[T]) {
    assert_eq!(list.len(), others.len(), "a list of the same length");
    change(list, others, |value, &other| *value = other);
}

/// Whether a condition holds for all rows.
#[track_caller]
pub fn all_rows(count: usize, holds: impl Fn(usize) -> bool + Sync + Send) -> bool {
    rows(count).measured().all(holds)
}

/// Whether two lists are the same.
#[track_caller]
pub fn equal<T: PartialEq + Sync>(list: &[T], other: &[T]) -> bool {
    let rows = rows_of_part::<T>(list.len());
    let parts = list.par_chunks(rows).zip(other.par_chunks(rows));
    list.len() == other.len() && parts.measured().all(|(list, other)| list == other)
}

/// Greatest value of a function over a list, at least 0; NaN is ignored.
#[track_caller]
pub fn greatest<T: Sync>(list: &[T], value: impl Fn(&T) -> f64 + Sync + Send) -> f64 {
    list.par_iter().with_min_len(rows_of_part::<T>(list.len())).map(value).measured().reduce(|| 0.0, f64::max)
}

/// Least value of a function of all rows; infinite without rows, and NaN is ignored.
#[track_caller]
pub fn least(count: usize, value: impl Fn(usize) -> f64 + Sync + Send) -> f64 {
    rows(count).map(value).measured().reduce(|| f64::INFINITY, f64::min)
}

/// The values of tiles, one after the other. Each tile is freed as soon as it is copied.
#[track_caller]
pub fn concat<T: Copy + Send + Sync>(tiles: Vec<Vec<T>>) -> Vec<T> {
    let total = tiles.iter().map(Vec::len).sum();
    let mut joined = Vec::with_capacity(total);
    let parts = split(&mut joined.spare_capacity_mut()[..total], tiles.iter().map(Vec::len));
    parts.into_par_iter().zip(tiles).measured().for_each(|(part, tile): (&mut [MaybeUninit<T>], Vec<T>)| {
        part.iter_mut().zip(&tile).for_each(|(place, &value)| _ = place.write(value));
    });
    // SAFETY: the parts are as long as the tiles and cover the list, and each has been written.
    unsafe { joined.set_len(total) };
    joined
}

/// Consecutive parts of a list.
pub fn split<T>(mut list: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    let mut next = |length: usize| {
        let (part, rest) = std::mem::take(&mut list).split_at_mut(length);
        list = rest;
        part
    };
    lengths.map(&mut next).collect()
}

/// A list into which threads write concurrently, in any order.
pub struct ScatteredWrites<'a, T> {
    first: *mut T,
    length: usize,
    list: PhantomData<&'a mut [T]>,
}

// SAFETY: the list stays mutably borrowed, and callers of `set` write each element on one thread at a time.
unsafe impl<T: Send> Sync for ScatteredWrites<'_, T> {}

impl<'a, T: Copy> ScatteredWrites<'a, T> {
    /// Into a list whose elements have values already.
    pub fn into(list: &'a mut [T]) -> Self {
        Self { first: list.as_mut_ptr(), length: list.len(), list: PhantomData }
    }

    /// Sets an element.
    ///
    /// # Safety
    ///
    /// No other thread may set the same element.
    ///
    /// # Panics
    ///
    /// If the element is beyond the list.
    #[inline(always)]
    pub unsafe fn set(&self, element: usize, value: T) {
        assert!(element < self.length, "an element of the list");
        // SAFETY: an element of the list, which no other thread writes.
        unsafe { self.first.add(element).write(value) };
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::on_threads;
    use super::*;
    use proptest::prelude::*;

    fn least_of(numbers: &[u32]) -> f64 {
        numbers.iter().map(|&number| -f64::from(number)).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        #[test]
        fn lists_are_those_of_a_loop(
            numbers in proptest::collection::vec(any::<u32>(), 0..12_000), tile in 1_usize..2000,
        ) {
            let expected: Vec<u64> = numbers.iter().map(|&number| u64::from(number) * 7).collect();
            let tiles: Vec<Vec<u32>> = numbers.chunks(tile).map(<[u32]>::to_vec).chain([Vec::new()]).collect();
            let most = numbers.iter().map(|&number| f64::from(number)).fold(0.0, f64::max);
            on_threads(|_| {
                assert_eq!(mapped(&numbers, |&number| u64::from(number) * 7), expected);
                assert_eq!(of_rows(numbers.len(), |row| u64::from(numbers[row]) * 7), expected);
                let mut changed = mapped(&numbers, |&number| u64::from(number));
                change(&mut changed, &numbers, |value, &number| *value += 6 * u64::from(number));
                assert!(equal(&changed, &expected));
                overwrite(&mut changed, &mapped(&numbers, |&number| u64::from(number)));
                change_rows(&mut changed, |row, value| *value += 6 * u64::from(numbers[row]));
                assert!(equal(&changed, &expected));
                let mut counted = numbers.clone();
                let before = mapped_mut(&mut counted, |row, value| std::mem::replace(value, row as u32));
                assert!(before == numbers && counted.iter().zip(0..).all(|(&row, expected)| row == expected));
                let (doubled, blocks) = in_blocks(numbers.len(), tile, |first, block: &mut [u64]| {
                    block.iter_mut().zip(&numbers[first..]).for_each(|(sum, &number)| *sum += 7 * u64::from(number));
                    (first, block.len())
                });
                let firsts = (0..numbers.len()).step_by(tile);
                let ranges: Vec<_> = firsts.map(|first| (first, tile.min(numbers.len() - first))).collect();
                assert!(doubled == expected && blocks == ranges);
                assert!(concat(tiles.clone()) == numbers && copied(&numbers) == numbers);
                let smallest = least(numbers.len(), |row| -f64::from(numbers[row]));
                assert_eq!(smallest.to_bits(), least_of(&numbers).to_bits());
                assert_eq!(greatest(&numbers, |&number| f64::from(number)).to_bits(), most.to_bits());
            });
        }

        #[test]
        fn lists_differ_if_one_element_does(count in 1_usize..12_000, place in any::<usize>()) {
            let list = vec![1.5; count];
            let mut other = list.clone();
            assert!(equal(&list, &other) && !equal(&list, &other[1..]));
            other[place % count] = f64::NAN;
            on_threads(|_| assert!(!equal(&list, &other)));
        }

        #[test]
        fn scattered_elements_are_where_they_were_set(count in 1_usize..12_000, step in 1_usize..9) {
            // Every element once: multiples of a number without a common factor.
            let step = if count % (2 * step + 1) == 0 { 1 } else { 2 * step + 1 };
            prop_assume!((2..=step).all(|d| step % d != 0 || count % d != 0));
            on_threads(|_| {
                let mut list = vec![usize::MAX; count];
                let scatter = ScatteredWrites::into(&mut list);
                // SAFETY: the elements are different.
                rows(count).for_each(|row| unsafe { scatter.set(row * step % count, row) });
                assert!((0..count).all(|row| list[row * step % count] == row));
            });
        }
    }

    #[test]
    #[should_panic(expected = "an element of the list")]
    fn elements_beyond_a_list_are_refused() {
        // SAFETY: no other thread.
        unsafe { ScatteredWrites::into(&mut [1, 2]).set(2, 3) };
    }
}
