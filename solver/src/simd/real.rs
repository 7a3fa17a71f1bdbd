//! Requirements of values on the grid.

#[cfg(target_arch = "x86_64")]
use crate::simd::x86;
use crate::simd::{Level, Vector, Work};
use bytemuck::Pod;
use std::fmt::{Debug, Display};
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A grid value, `f32` or `f64`. Everything outside of the grid is `f64`.
pub trait Real:
    Pod
    + Send
    + Sync
    + Default
    + Debug
    + Display
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Sum
{
    /// Number of values in 64 bytes: a cache line, and the widest vector register.
    const LANES: usize = 64 / size_of::<Self>();
    /// Vector of half as many, for any machine.
    type Half: Vector<Self>;
    /// Distance from 1 to the next larger value.
    const EPSILON: f64;

    /// The nearest value of this type.
    fn from_f64(value: f64) -> Self;

    /// The same value in `f64`.
    fn to_f64(self) -> f64;

    /// `self * factor + term`, rounded once.
    #[must_use]
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// `2^self` for an integer for which that is a normal number.
    #[must_use]
    fn power_of_two(self) -> Self;

    /// Runs a kernel with this type's vectors for the given instruction set.
    ///
    /// # Safety
    /// `level` is [`Level::Portable`] or was found by [`Level::detect`].
    unsafe fn dispatch_at<W: Work<Self>>(level: Level, work: W) -> W::Output;

    /// Runs a kernel with the widest vectors of this machine.
    fn dispatch<W: Work<Self>>(work: W) -> W::Output {
        // SAFETY: the level is this machine's.
        unsafe { Self::dispatch_at(Level::detect(), work) }
    }
}

macro_rules! real {
    ($type:ty, $bits:ty, $avx2:ty, $avx512:ty) => {
        impl Real for $type {
            type Half = [Self; Self::LANES / 2];
            const EPSILON: f64 = <$type>::EPSILON as f64;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as Self
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.into()
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                <$type>::mul_add(self, factor, term)
            }

            #[inline(always)]
            fn power_of_two(self) -> Self {
                let exponent = self as i32 + <$type>::MAX_EXP - 1;
                <$type>::from_bits((exponent as $bits) << (<$type>::MANTISSA_DIGITS - 1))
            }

            unsafe fn dispatch_at<W: Work<Self>>(level: Level, work: W) -> W::Output {
                match level {
                    Level::Portable => work.run::<[Self; Self::LANES]>(),
                    // SAFETY: the machine has these instructions, as the caller promises.
                    #[cfg(target_arch = "x86_64")]
                    Level::Avx2 => unsafe {
                        x86::avx2(
                            #[inline(always)]
                            || work.run::<$avx2>(),
                        )
                    },
                    // SAFETY: the machine has these instructions, as the caller promises.
                    #[cfg(target_arch = "x86_64")]
                    Level::Avx512 => unsafe {
                        x86::avx512(
                            #[inline(always)]
                            || work.run::<$avx512>(),
                        )
                    },
                }
            }
        }
    };
}

real!(f32, u32, x86::Two<std::arch::x86_64::__m256>, std::arch::x86_64::__m512);
real!(f64, u64, x86::Two<std::arch::x86_64::__m256d>, std::arch::x86_64::__m512d);
