//! Storing and restoring the state of estimators, bit for bit.

use bytemuck::Pod;

/// An estimator whose state can be stored. An estimator made with the same parameters and visited with a [`Loader`]
/// has the state that was visited with the [`Saver`].
pub trait State {
    /// Passes all numbers that depend on samples to a store, always in the same order.
    fn visit(&mut self, store: &mut dyn Store);

    /// State as bytes.
    fn save(&mut self) -> Vec<u8>
    where
        Self: Sized,
    {
        let mut saver = Saver::default();
        self.visit(&mut saver);
        saver.0
    }

    /// Restores a state; returns whether it fits.
    #[must_use]
    fn load(&mut self, bytes: &[u8]) -> bool
    where
        Self: Sized,
    {
        let mut loader = Loader { rest: bytes, fits: true };
        self.visit(&mut loader);
        loader.fits && loader.rest.is_empty()
    }
}

/// Structs that consist of numbers of 64 bits are states by themselves: their fields in order.
impl<T: Pod> State for T {
    fn visit(&mut self, store: &mut dyn Store) {
        const { assert!(size_of::<T>().is_multiple_of(size_of::<u64>()) && align_of::<T>() == align_of::<u64>()) }
        for word in bytemuck::cast_slice_mut(std::slice::from_mut(self)) {
            store.count(word);
        }
    }
}

impl<T: State> State for [T] {
    fn visit(&mut self, store: &mut dyn Store) {
        for state in self {
            state.visit(store);
        }
    }
}

/// Destination or source of stored numbers.
pub trait Store {
    /// A list, whose length is also stored.
    fn numbers(&mut self, values: &mut Vec<f64>);

    /// An integer.
    fn count(&mut self, value: &mut u64);

    /// A floating-point number.
    fn number(&mut self, value: &mut f64) {
        let mut bits = value.to_bits();
        self.count(&mut bits);
        *value = f64::from_bits(bits);
    }
}

/// Stores numbers as bytes.
#[derive(Debug, Default)]
pub struct Saver(Vec<u8>);

impl Store for Saver {
    fn numbers(&mut self, values: &mut Vec<f64>) {
        self.count(&mut (values.len() as u64));
        self.0.extend(bytemuck::cast_slice::<f64, u8>(values));
    }

    fn count(&mut self, value: &mut u64) {
        self.0.extend(value.to_le_bytes());
    }
}

/// Restores numbers from bytes.
#[derive(Debug)]
pub struct Loader<'a> {
    rest: &'a [u8],
    fits: bool,
}

impl Loader<'_> {
    fn take(&mut self, length: usize) -> &[u8] {
        let taken = self.rest.split_at_checked(length);
        self.fits &= taken.is_some();
        let (taken, rest) = taken.unwrap_or_default();
        self.rest = rest;
        taken
    }
}

impl Store for Loader<'_> {
    fn numbers(&mut self, values: &mut Vec<f64>) {
        let mut length = 0;
        self.count(&mut length);
        let bytes = self.take((length as usize).saturating_mul(size_of::<f64>()));
        *values = bytes.chunks_exact(size_of::<f64>()).map(bytemuck::pod_read_unaligned).collect();
    }

    fn count(&mut self, value: &mut u64) {
        *value = self.take(size_of::<u64>()).try_into().map_or(0, u64::from_le_bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;

    #[derive(Default, PartialEq, Debug)]
    struct Two(Vec<f64>, u64, f64);

    impl State for Two {
        fn visit(&mut self, store: &mut dyn Store) {
            store.numbers(&mut self.0);
            store.count(&mut self.1);
            store.number(&mut self.2);
        }
    }

    #[test]
    fn what_is_stored_comes_back() {
        let mut two = Two(vec![0.1, f64::INFINITY], 7, -0.3);
        let bytes = two.save();
        let mut again = Two::default();
        assert!(again.load(&bytes));
        assert_eq!(again, two);
        assert!(!Two::default().load(&bytes[1..]) && !Two::default().load(&[&bytes[..], &[0]].concat()));
    }

    #[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
    #[repr(C)]
    struct Plain {
        place: domain::Vector,
        count: u64,
    }

    #[test]
    fn plain_numbers_are_stored_field_by_field() {
        let mut list = [1.0, -0.0].map(|x| Plain { place: domain::Vector::new(x, 0.1, f64::INFINITY), count: 7 });
        let mut saver = Saver::default();
        list[..].visit(&mut saver);
        let mut expected = Saver::default();
        for Plain { place, count } in &mut list {
            place.as_mut().iter_mut().for_each(|number| expected.number(number));
            expected.count(count);
        }
        assert_eq!(saver.0, expected.0);
        let mut again = Plain::default();
        assert!(again.load(&saver.0[..32]) && again == list[0]);
    }
}
