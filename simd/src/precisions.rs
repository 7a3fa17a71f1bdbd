//! Vectors of the two precisions for each set of instructions.

#[cfg(target_arch = "x86_64")]
use crate::x86;
use crate::{InstructionSet, Real, VectorKernel};

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

            unsafe fn dispatch_at<W: VectorKernel<Self>>(level: InstructionSet, work: W) -> W::Output {
                match level {
                    InstructionSet::Portable => work.run::<[Self; Self::LANES]>(),
                    // SAFETY: the machine has these instructions, as the caller promises.
                    #[cfg(target_arch = "x86_64")]
                    InstructionSet::Avx2 => unsafe {
                        x86::avx2(
                            #[inline(always)]
                            || work.run::<$avx2>(),
                        )
                    },
                    // SAFETY: the machine has these instructions, as the caller promises.
                    #[cfg(target_arch = "x86_64")]
                    InstructionSet::Avx512 => unsafe {
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
