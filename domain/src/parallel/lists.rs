//! Lists that are made, compared and joined by all threads. Each is the one that a serial loop makes.

use super::MeasuredLoop;
use rayon::prelude::*;
use std::marker::PhantomData;
use std::mem::MaybeUninit;

/// Rows that one thread processes at a time, at least, if a row takes tens of nanoseconds.
const BATCH: usize = 1024;

/// The same if a row takes hardly longer than to copy it: shorter lists are not worth the wake-up of a thread.
const COPIED_TOGETHER: usize = 4096;

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
    let parts = values.spare_capacity_mut()[..list.len()].par_chunks_mut(COPIED_TOGETHER);
    parts.zip(list.par_chunks(COPIED_TOGETHER)).measured().for_each(|(part, elements)| {
        part.iter_mut().zip(elements).for_each(|(place, element)| _ = place.write(value(element)));
    });
    // SAFETY: all parts have been written, and together they are as long as the list.
    unsafe { values.set_len(list.len()) };
    values
}

/// A copy of a list.
#[track_caller]
pub fn copied<T: Copy + Send + Sync>(list: &[T]) -> Vec<T> {
    mapped(list, |&value| value)
}

/// Changes each element of a list by that of another one. The longer list is cut off.
#[track_caller]
pub fn change<T: Send, U: Sync>(list: &mut [T], others: &[U], change: impl Fn(&mut T, &U) + Sync) {
    let parts = list.par_chunks_mut(COPIED_TOGETHER).zip(others.par_chunks(COPIED_TOGETHER));
    parts.measured().for_each(|(list, others)| {
        list.iter_mut().zip(others).for_each(|(value, other)| change(value, other));
    });
}

/// Changes each element of a list by a function of its row.
#[track_caller]
pub fn change_rows<T: Send>(list: &mut [T], change: impl Fn(usize, &mut T) + Sync) {
    list.par_chunks_mut(COPIED_TOGETHER).enumerate().measured().for_each(|(k, list)| {
        list.iter_mut().zip(k * COPIED_TOGETHER..).for_each(|(value, row)| change(row, value));
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
    let parts = list.par_chunks(COPIED_TOGETHER).zip(other.par_chunks(COPIED_TOGETHER));
    list.len() == other.len() && parts.measured().all(|(list, other)| list == other)
}

/// Greatest value of a function over a list, at least 0; NaN is ignored.
#[track_caller]
pub fn greatest<T: Sync>(list: &[T], value: impl Fn(&T) -> f64 + Sync + Send) -> f64 {
    list.par_iter().with_min_len(COPIED_TOGETHER).map(value).measured().reduce(|| 0.0, f64::max)
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
            numbers in proptest::collection::vec(any::<u32>(), 0..3 * COPIED_TOGETHER), tile in 1_usize..2000,
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
                assert!(concat(tiles.clone()) == numbers && copied(&numbers) == numbers);
                let smallest = least(numbers.len(), |row| -f64::from(numbers[row]));
                assert_eq!(smallest.to_bits(), least_of(&numbers).to_bits());
                assert_eq!(greatest(&numbers, |&number| f64::from(number)).to_bits(), most.to_bits());
            });
        }

        #[test]
        fn lists_differ_if_one_element_does(count in 1_usize..3 * COPIED_TOGETHER, place in any::<usize>()) {
            let list = vec![1.5; count];
            let mut other = list.clone();
            assert!(equal(&list, &other) && !equal(&list, &other[1..]));
            other[place % count] = f64::NAN;
            on_threads(|_| assert!(!equal(&list, &other)));
        }

        #[test]
        fn scattered_elements_are_where_they_were_set(count in 1_usize..3 * COPIED_TOGETHER, step in 1_usize..9) {
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
