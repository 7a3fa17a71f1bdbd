//! Complex transforms of columns of any length.

use super::columns::{ColumnPlan, StridedPointer};
use super::gathered::Gathered;
use super::{Direction, is_product_of};
use crate::Real;

/// Plan for columns of `n` elements: lane kernels if they support all prime factors of `n`, otherwise rustfft.
pub(crate) enum AnyLength<T> {
    Lanes(ColumnPlan<T>),
    Gathered(Gathered<T>),
}

impl<T: Real> AnyLength<T> {
    pub fn new(length: usize) -> Self {
        if is_product_of(&[2, 3, 5, 7], length) {
            Self::Lanes(ColumnPlan::new(length))
        } else {
            Self::by_rustfft(length)
        }
    }

    /// Plan by rustfft, even if lane kernels are available.
    pub fn by_rustfft(length: usize) -> Self {
        Self::Gathered(Gathered::new(length))
    }

    pub fn length(&self) -> usize {
        match self {
            Self::Lanes(plan) => plan.length(),
            Self::Gathered(plan) => plan.length(),
        }
    }

    /// Number of values that each buffer needs to hold.
    pub fn room(&self) -> usize {
        match self {
            Self::Lanes(plan) => 2 * T::LANES * plan.length(),
            Self::Gathered(plan) => plan.room(),
        }
    }

    /// Transforms the columns at `from` into those at `to`, which may be the same.
    ///
    /// # Safety
    /// The elements at `from` can be read, those at `to` written, with no concurrent access; each of the two buffers
    /// has [`Self::room`].
    pub unsafe fn run(
        &self,
        direction: Direction,
        from: StridedPointer<T>,
        to: StridedPointer<T>,
        buffers: [*mut T; 2],
    ) {
        // SAFETY: guaranteed by the caller.
        unsafe {
            match self {
                Self::Lanes(plan) => plan.run(direction, from, to, buffers),
                Self::Gathered(plan) => plan.run(direction, from, to, buffers),
            }
        }
    }
}
