//! A run's counts and sums as one list of numbers, for a checkpoint.

use super::{Grains, Lid, State, Tally, WallTally};
use domain::Vector;

/// Numbers that are put in one after another and taken out in the same order. What is missing is taken as zero or empty,
/// and leaves the list short.
#[derive(Debug, Default)]
pub struct Numbers {
    values: Vec<f64>,
    taken: usize,
    short: bool,
}

impl From<&[f64]> for Numbers {
    fn from(values: &[f64]) -> Self {
        Self { values: values.to_vec(), ..Self::default() }
    }
}

impl Numbers {
    /// Puts in some numbers.
    pub fn put(&mut self, values: &[f64]) {
        self.values.extend(values);
    }

    /// Puts in a list and its length.
    pub fn list(&mut self, values: &[f64]) {
        self.put(&[values.len() as f64]);
        self.put(values);
    }

    /// Puts in a list of vectors and its length.
    pub fn vectors(&mut self, vectors: &[Vector]) {
        self.list(&vectors.iter().flat_map(Vector::to_array).collect::<Vec<_>>());
    }

    /// All numbers.
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    /// Takes some numbers.
    pub fn take<const N: usize>(&mut self) -> [f64; N] {
        let next = self.values[self.taken..].first_chunk().copied();
        self.short |= next.is_none();
        self.taken += if next.is_some() { N } else { 0 };
        next.unwrap_or([0.0; N])
    }

    /// Takes a list.
    pub fn take_list(&mut self) -> Vec<f64> {
        let [length] = self.take();
        let next = self.values[self.taken..].get(..length as usize).map(<[f64]>::to_vec);
        self.short |= next.is_none();
        let list = next.unwrap_or_default();
        self.taken += list.len();
        list
    }

    /// Takes a list of vectors.
    pub fn take_vectors(&mut self) -> Vec<Vector> {
        self.take_list().chunks_exact(3).map(Vector::from_slice).collect()
    }

    /// Whether all numbers were taken and none was missing.
    pub fn are_spent(&self) -> bool {
        !self.short && self.taken == self.values.len()
    }
}

impl State {
    /// Puts in all but the grains.
    pub(super) fn keep(&self, numbers: &mut Numbers) {
        let Tally { time, walls, body_impulse, body_work, load_work, dissipated, .. } = self.tally;
        let Tally { pair_hits, elastic_hits, largest_overlap, overlaps, .. } = self.tally;
        numbers.put(&[self.lid.height, self.lid.velocity, time]);
        for WallTally { impulse, work, hits } in walls {
            numbers.put(&impulse.to_array());
            numbers.put(&[work, hits as f64]);
        }
        numbers.put(&body_impulse.to_array());
        numbers.put(&[body_work, load_work, dissipated]);
        numbers.put(&[pair_hits as f64, elastic_hits as f64, largest_overlap, overlaps]);
    }

    /// A state with these grains.
    pub(super) fn kept(grains: &Grains, numbers: &mut Numbers) -> Self {
        let [height, velocity, time] = numbers.take();
        let walls = std::array::from_fn(|_| {
            let [x, y, z, work, hits] = numbers.take();
            WallTally { impulse: Vector::new(x, y, z), work, hits: hits as u64 }
        });
        let body_impulse = Vector::from_array(numbers.take());
        let [body_work, load_work, dissipated] = numbers.take();
        let [pair_hits, elastic_hits, largest_overlap, overlaps] = numbers.take();
        let tally = Tally {
            time,
            walls,
            body_impulse,
            body_work,
            load_work,
            dissipated,
            pair_hits: pair_hits as u64,
            elastic_hits: elastic_hits as u64,
            largest_overlap,
            overlaps,
        };
        Self { grains: grains.clone(), lid: Lid { height, velocity }, tally }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_in_is_taken_out_and_what_is_missing_is_noticed() {
        let mut numbers = Numbers::default();
        numbers.put(&[1.0, 2.0]);
        numbers.vectors(&[Vector::X, Vector::Y]);
        let values = numbers.into_values();
        let mut whole = Numbers::from(values.as_slice());
        assert_eq!((whole.take(), whole.take_vectors()), ([1.0, 2.0], vec![Vector::X, Vector::Y]));
        assert!(whole.are_spent());
        let mut cut = Numbers::from(&values[..5]);
        assert_eq!((cut.take(), cut.take_vectors()), ([1.0, 2.0], vec![]));
        assert!(!cut.are_spent() && !Numbers::from(values.as_slice()).are_spent());
    }
}
