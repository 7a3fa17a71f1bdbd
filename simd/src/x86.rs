//! Vectors of x86-64 processors.

#![allow(clippy::needless_range_loop, reason = "loops over registers, by index so that they unroll")]

use super::{SimdVector, StridedRows};
use crate::Real;
#[allow(clippy::wildcard_imports, reason = "the instructions")]
use std::arch::x86_64::*;

#[inline]
pub fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && has_avx2()
}

#[inline]
pub fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

/// Runs work compiled for AVX-512, as far as it is inlined.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma")]
pub fn avx512<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// Runs work compiled for AVX2, as far as it is inlined.
#[target_feature(enable = "avx2,fma")]
pub fn avx2<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// A cache line in two registers.
#[derive(Clone, Copy)]
pub struct Two<R>(R, R);

// SAFETY of every intrinsic below: vectors of these types exist only in work that `avx512` or `avx2` runs, on
// machines that have the instructions.
macro_rules! one_register {
    ($real:ty, $register:ty, $half:ty, $lanes:literal, $transpose:path, $scale:path,
     $load:ident, $store:ident, $splat:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $fma:ident, $fnma:ident,
     $max:ident) => {
        impl SimdVector<$real> for $register {
            const LANES: usize = $lanes;
            type Half = $half;

            #[inline(always)]
            unsafe fn load(from: *const $real) -> Self {
                unsafe { $load(from) }
            }

            #[inline(always)]
            unsafe fn store(self, to: *mut $real) {
                unsafe { $store(to, self) }
            }

            #[inline(always)]
            fn splat(value: $real) -> Self {
                unsafe { $splat(value) }
            }

            #[inline(always)]
            fn add(self, other: Self) -> Self {
                unsafe { $add(self, other) }
            }

            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                unsafe { $sub(self, other) }
            }

            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                unsafe { $mul(self, other) }
            }

            #[inline(always)]
            fn div(self, other: Self) -> Self {
                unsafe { $div(self, other) }
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                unsafe { $fma(self, factor, term) }
            }

            #[inline(always)]
            fn mul_sub_from(self, factor: Self, term: Self) -> Self {
                unsafe { $fnma(self, factor, term) }
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                unsafe { $max(self, other) }
            }

            #[inline(always)]
            fn times_power_of_two(self, exponent: Self) -> Self {
                unsafe { $scale(self, exponent) }
            }

            #[inline(always)]
            unsafe fn transpose(from: StridedRows<*const $real>, to: StridedRows<*mut $real>) {
                unsafe { $transpose(from, to) }
            }
        }
    };
}

macro_rules! two_registers {
    ($real:ty, $register:ty, $lanes:literal, $load:ident, $store:ident, $splat:ident, $add:ident, $sub:ident,
     $mul:ident, $div:ident, $fma:ident, $fnma:ident) => {
        impl SimdVector<$real> for Two<$register> {
            const LANES: usize = 2 * $lanes;
            type Half = $register;

            #[inline(always)]
            unsafe fn load(from: *const $real) -> Self {
                unsafe { Self($load(from), $load(from.add($lanes))) }
            }

            #[inline(always)]
            unsafe fn store(self, to: *mut $real) {
                unsafe {
                    $store(to, self.0);
                    $store(to.add($lanes), self.1);
                }
            }

            #[inline(always)]
            fn splat(value: $real) -> Self {
                unsafe { Self($splat(value), $splat(value)) }
            }

            #[inline(always)]
            fn add(self, other: Self) -> Self {
                unsafe { Self($add(self.0, other.0), $add(self.1, other.1)) }
            }

            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                unsafe { Self($sub(self.0, other.0), $sub(self.1, other.1)) }
            }

            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                unsafe { Self($mul(self.0, other.0), $mul(self.1, other.1)) }
            }

            #[inline(always)]
            fn div(self, other: Self) -> Self {
                unsafe { Self($div(self.0, other.0), $div(self.1, other.1)) }
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                unsafe { Self($fma(self.0, factor.0, term.0), $fma(self.1, factor.1, term.1)) }
            }

            #[inline(always)]
            fn mul_sub_from(self, factor: Self, term: Self) -> Self {
                unsafe { Self($fnma(self.0, factor.0, term.0), $fnma(self.1, factor.1, term.1)) }
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self(self.0.max(other.0), self.1.max(other.1))
            }

            #[inline(always)]
            fn times_power_of_two(self, exponent: Self) -> Self {
                Self(self.0.times_power_of_two(exponent.0), self.1.times_power_of_two(exponent.1))
            }

            #[inline(always)]
            unsafe fn transpose(from: StridedRows<*const $real>, to: StridedRows<*mut $real>) {
                unsafe { transpose_plainly::<$real, { 2 * $lanes }>(from, to) }
            }
        }
    };
}

one_register!(
    f64,
    __m512d,
    __m256d,
    8,
    transpose_8,
    _mm512_scalef_pd,
    _mm512_loadu_pd,
    _mm512_storeu_pd,
    _mm512_set1_pd,
    _mm512_add_pd,
    _mm512_sub_pd,
    _mm512_mul_pd,
    _mm512_div_pd,
    _mm512_fmadd_pd,
    _mm512_fnmadd_pd,
    _mm512_max_pd
);
one_register!(
    f32,
    __m512,
    __m256,
    16,
    transpose_16,
    _mm512_scalef_ps,
    _mm512_loadu_ps,
    _mm512_storeu_ps,
    _mm512_set1_ps,
    _mm512_add_ps,
    _mm512_sub_ps,
    _mm512_mul_ps,
    _mm512_div_ps,
    _mm512_fmadd_ps,
    _mm512_fnmadd_ps,
    _mm512_max_ps
);
one_register!(
    f64,
    __m256d,
    __m256d,
    4,
    transpose_plainly::<f64, 4>,
    times_power_of_two_f64,
    _mm256_loadu_pd,
    _mm256_storeu_pd,
    _mm256_set1_pd,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_div_pd,
    _mm256_fmadd_pd,
    _mm256_fnmadd_pd,
    _mm256_max_pd
);
one_register!(
    f32,
    __m256,
    __m256,
    8,
    transpose_plainly::<f32, 8>,
    times_power_of_two_f32,
    _mm256_loadu_ps,
    _mm256_storeu_ps,
    _mm256_set1_ps,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_fmadd_ps,
    _mm256_fnmadd_ps,
    _mm256_max_ps
);
two_registers!(
    f64,
    __m256d,
    4,
    _mm256_loadu_pd,
    _mm256_storeu_pd,
    _mm256_set1_pd,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_div_pd,
    _mm256_fmadd_pd,
    _mm256_fnmadd_pd
);
two_registers!(
    f32,
    __m256,
    8,
    _mm256_loadu_ps,
    _mm256_storeu_ps,
    _mm256_set1_ps,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_fmadd_ps,
    _mm256_fnmadd_ps
);

/// `value * 2^exponent`: the exponent in the low bits of a large number, shifted to the exponent bits.
#[inline(always)]
unsafe fn times_power_of_two_f64(value: __m256d, exponent: __m256d) -> __m256d {
    unsafe {
        let shifted = _mm256_add_pd(exponent, _mm256_set1_pd(6_755_399_441_055_744.0 + 1023.0));
        _mm256_mul_pd(value, _mm256_castsi256_pd(_mm256_slli_epi64::<52>(_mm256_castpd_si256(shifted))))
    }
}

/// The same for `f32`.
#[inline(always)]
unsafe fn times_power_of_two_f32(value: __m256, exponent: __m256) -> __m256 {
    unsafe {
        let shifted = _mm256_add_ps(exponent, _mm256_set1_ps(12_582_912.0 + 127.0));
        _mm256_mul_ps(value, _mm256_castsi256_ps(_mm256_slli_epi32::<23>(_mm256_castps_si256(shifted))))
    }
}

/// Transposes as on any machine; rarely used here.
#[inline(always)]
unsafe fn transpose_plainly<T: Real, const LANES: usize>(from: StridedRows<*const T>, to: StridedRows<*mut T>) {
    unsafe { <[T; LANES] as SimdVector<T>>::transpose(from, to) }
}

/// Transposes 8 x 8 values: neighbours in pairs of rows first, then the quarters of four such pairs.
#[inline(always)]
unsafe fn transpose_8(from: StridedRows<*const f64>, to: StridedRows<*mut f64>) {
    unsafe {
        let mut pairs = [[_mm512_setzero_pd(); 4]; 2];
        for g in 0..4 {
            let a = _mm512_loadu_pd(from.first.add(2 * g * from.stride));
            let b = _mm512_loadu_pd(from.first.add((2 * g + 1) * from.stride));
            pairs[0][g] = _mm512_unpacklo_pd(a, b);
            pairs[1][g] = _mm512_unpackhi_pd(a, b);
        }
        for j in 0..2 {
            let columns = transpose_quarters(pairs[j]);
            for quarter in 0..4 {
                _mm512_storeu_pd(to.first.add((2 * quarter + j) * to.stride), columns[quarter]);
            }
        }
    }
}

/// Transposes 16 x 16 values: groups of four rows first, then the quarters of four such groups.
#[inline(always)]
unsafe fn transpose_16(from: StridedRows<*const f32>, to: StridedRows<*mut f32>) {
    unsafe {
        let mut groups = [[_mm512_setzero_pd(); 4]; 4];
        for g in 0..4 {
            let a = _mm512_loadu_ps(from.first.add(4 * g * from.stride));
            let b = _mm512_loadu_ps(from.first.add((4 * g + 1) * from.stride));
            let c = _mm512_loadu_ps(from.first.add((4 * g + 2) * from.stride));
            let d = _mm512_loadu_ps(from.first.add((4 * g + 3) * from.stride));
            let (ab_low, ab_high) = (_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
            let (cd_low, cd_high) = (_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
            let (ab_low, cd_low) = (_mm512_castps_pd(ab_low), _mm512_castps_pd(cd_low));
            let (ab_high, cd_high) = (_mm512_castps_pd(ab_high), _mm512_castps_pd(cd_high));
            groups[0][g] = _mm512_unpacklo_pd(ab_low, cd_low);
            groups[1][g] = _mm512_unpackhi_pd(ab_low, cd_low);
            groups[2][g] = _mm512_unpacklo_pd(ab_high, cd_high);
            groups[3][g] = _mm512_unpackhi_pd(ab_high, cd_high);
        }
        for j in 0..4 {
            let columns = transpose_quarters(groups[j]);
            for quarter in 0..4 {
                _mm512_storeu_ps(to.first.add((4 * quarter + j) * to.stride), _mm512_castpd_ps(columns[quarter]));
            }
        }
    }
}

/// Transposes the 4 x 4 quarters of four registers.
#[inline(always)]
unsafe fn transpose_quarters([a, b, c, d]: [__m512d; 4]) -> [__m512d; 4] {
    const EVEN: i32 = 0b10_00_10_00;
    const ODD: i32 = 0b11_01_11_01;
    unsafe {
        let [ab_even, ab_odd] = [_mm512_shuffle_f64x2::<EVEN>(a, b), _mm512_shuffle_f64x2::<ODD>(a, b)];
        let [cd_even, cd_odd] = [_mm512_shuffle_f64x2::<EVEN>(c, d), _mm512_shuffle_f64x2::<ODD>(c, d)];
        [
            _mm512_shuffle_f64x2::<EVEN>(ab_even, cd_even),
            _mm512_shuffle_f64x2::<EVEN>(ab_odd, cd_odd),
            _mm512_shuffle_f64x2::<ODD>(ab_even, cd_even),
            _mm512_shuffle_f64x2::<ODD>(ab_odd, cd_odd),
        ]
    }
}
