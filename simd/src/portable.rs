//! Vectors for any machine.

use super::{SimdVector, StridedRows};
use crate::Real;

/// An array element by element, as a loop: `std::array::from_fn` need not be inlined.
macro_rules! each {
    ($i:ident, $value:expr) => {{
        let mut result = [T::default(); LANES];
        for $i in 0..LANES {
            result[$i] = $value;
        }
        result
    }};
}

impl<T: Real, const LANES: usize> SimdVector<T> for [T; LANES] {
    const LANES: usize = LANES;
    type Half = T::Half;

    #[inline(always)]
    unsafe fn load(from: *const T) -> Self {
        // SAFETY: guaranteed by the caller.
        unsafe { from.cast::<Self>().read() }
    }

    #[inline(always)]
    unsafe fn store(self, to: *mut T) {
        // SAFETY: guaranteed by the caller.
        unsafe { to.cast::<Self>().write(self) }
    }

    #[inline(always)]
    fn splat(value: T) -> Self {
        [value; LANES]
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        each!(i, self[i] + other[i])
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        each!(i, self[i] - other[i])
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        each!(i, self[i] * other[i])
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        each!(i, self[i] / other[i])
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        each!(i, self[i].mul_add(factor[i], term[i]))
    }

    #[inline(always)]
    fn mul_sub_from(self, factor: Self, term: Self) -> Self {
        each!(i, (-self[i]).mul_add(factor[i], term[i]))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        each!(i, if self[i] > other[i] { self[i] } else { other[i] })
    }

    #[inline(always)]
    fn times_power_of_two(self, exponent: Self) -> Self {
        each!(i, self[i] * exponent[i].power_of_two())
    }

    #[inline(always)]
    unsafe fn transpose(from: StridedRows<*const T>, to: StridedRows<*mut T>) {
        for i in 0..LANES {
            for j in 0..LANES {
                // SAFETY: guaranteed by the caller.
                unsafe { *to.first.add(j * to.stride + i) = *from.first.add(i * from.stride + j) };
            }
        }
    }
}
