//! Sums over the lanes of vectors.

use simd::{SimdVector as Lanes, StridedRows};
use solver::{AlignedMemory, Real};

/// Number of sums taken at once, padded with zeros: a multiple of the lanes of any vector.
const SUMS: usize = 16;

/// Sums of one particle, three of its velocity and nine of its gradient, lane by lane.
pub(crate) struct Totals<T> {
    lanes: AlignedMemory<T>,
    /// The transpose, with sums and lanes exchanged.
    turned: AlignedMemory<T>,
}

impl<T: Real> Default for Totals<T> {
    fn default() -> Self {
        Self { lanes: AlignedMemory::zero(SUMS * T::LANES), turned: AlignedMemory::zero(T::LANES * T::LANES) }
    }
}

impl<T: Real> Totals<T> {
    /// Sets all sums to zero.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.lanes.values_mut().fill(T::default());
    }

    /// Adds to the first lanes of each sum.
    #[inline(always)]
    pub fn add<V: Lanes<T>>(&mut self, terms: &[V; 12]) {
        for (sum, term) in self.lanes.values_mut().chunks_exact_mut(T::LANES).zip(terms) {
            // SAFETY: each sum has the lanes of a whole vector.
            unsafe { V::load(sum.as_ptr()).add(*term).store(sum.as_mut_ptr()) };
        }
    }

    /// Sums of these terms alone over their lanes.
    #[inline(always)]
    pub fn of<V: Lanes<T>>(&mut self, terms: &[V; 12]) -> [T; 12] {
        for (sum, term) in self.lanes.values_mut().chunks_exact_mut(V::LANES).zip(terms) {
            // SAFETY: a chunk has as many values as a vector.
            unsafe { term.store(sum.as_mut_ptr()) };
        }
        self.sums::<V>()
    }

    /// Sums over the lanes: always added in the same order, whatever the vectors.
    #[inline(always)]
    pub fn take<V: Lanes<T>>(&mut self) -> [T; 12] {
        self.sums::<V>()
    }

    #[inline(always)]
    fn sums<V: Lanes<T>>(&mut self) -> [T; 12] {
        let mut totals = [T::default(); SUMS];
        for first in (0..SUMS).step_by(V::LANES) {
            let from = self.lanes.values()[first * V::LANES..].as_ptr();
            let to = self.turned.values_mut().as_mut_ptr();
            // SAFETY: there are `SUMS` sums, a multiple of the lanes, and room for a square.
            unsafe {
                V::transpose(
                    StridedRows { first: from, stride: V::LANES },
                    StridedRows { first: to, stride: V::LANES },
                );
                let mut total = V::load(to);
                for lane in 1..V::LANES {
                    total = total.add(V::load(to.add(lane * V::LANES)));
                }
                total.store(totals.as_mut_ptr().add(first));
            }
        }
        let [sums @ .., _, _, _, _] = totals;
        sums
    }
}
