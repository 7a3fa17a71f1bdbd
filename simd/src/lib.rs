//! Vectors of the widest instruction set of the machine at run time.
//!
//! The crates are compiled for any processor of their family; this crate compiles a kernel again for each set of
//! vector instructions and selects the best at run time. Products and sums are fused everywhere (`mul_add`, rounded
//! once), so each set gives the same bits. Machines without fused instructions compute them in software: correctly,
//! but slowly.
//!
//! - [`vectorised`] runs a closure of plain loops, which the compiler vectorises.
//! - [`VectorKernel`] is a kernel written in [`SimdVector`]s, for code that the compiler does not vectorise by itself.
//!
//! In both, functions that are called but not inlined are compiled for any processor. So every function of a kernel
//! is `#[inline(always)]`, and loops are used instead of `std::array::from_fn` or `map`, which need not be inlined.

mod exponential;
mod portable;
mod precisions;
mod real;
mod strided_rows;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use exponential::exponential;
pub use real::Real;
pub use strided_rows::StridedRows;

use std::sync::OnceLock;

/// As many neighbouring values as fill a cache line of 64 bytes, processed at once.
///
/// All functions are meant to be inlined into [`VectorKernel::run`].
pub trait SimdVector<T: Real>: Copy {
    /// Number of values: [`Real::LANES`], or half of them.
    const LANES: usize;

    /// Vector of half as many values, for short lists; its own half is itself.
    type Half: SimdVector<T>;

    /// Reads neighbouring values.
    ///
    /// # Safety
    /// [`SimdVector::LANES`] values can be read at `from`.
    unsafe fn load(from: *const T) -> Self;

    /// Writes neighbouring values.
    ///
    /// # Safety
    /// [`SimdVector::LANES`] values can be written at `to`.
    unsafe fn store(self, to: *mut T);

    /// The same value in every lane.
    fn splat(value: T) -> Self;

    /// `self + other`
    #[must_use]
    fn add(self, other: Self) -> Self;

    /// `self - other`
    #[must_use]
    fn sub(self, other: Self) -> Self;

    /// `self * other`
    #[must_use]
    fn mul(self, other: Self) -> Self;

    /// `self / other`
    #[must_use]
    fn div(self, other: Self) -> Self;

    /// `self * factor + term`, rounded once.
    #[must_use]
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// `term - self * factor`, rounded once.
    #[must_use]
    fn mul_sub_from(self, factor: Self, term: Self) -> Self;

    /// The larger of both, lane by lane.
    #[must_use]
    fn max(self, other: Self) -> Self;

    /// `self * 2^exponent`, for integer exponents whose powers are normal numbers.
    #[must_use]
    fn times_power_of_two(self, exponent: Self) -> Self;

    /// Transposes a square of [`SimdVector::LANES`] rows and columns:
    /// `to[j][i] = from[i][j]`.
    ///
    /// # Safety
    /// The rows can be read and written, and the two squares do not overlap.
    unsafe fn transpose(from: StridedRows<*const T>, to: StridedRows<*mut T>);
}

/// A kernel in terms of vectors, compiled for each set of instructions; [`Real::dispatch`] runs it.
pub trait VectorKernel<T: Real> {
    /// Return type.
    type Output;

    /// Does the work. Implementations, and all functions that they call, are `#[inline(always)]`: only then are they
    /// compiled for the instruction set of the caller.
    fn run<V: SimdVector<T>>(self) -> Self::Output;
}

/// Sets of vector instructions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InstructionSet {
    /// Instructions of every machine for which the program was compiled.
    Portable,
    /// AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 with F, BW, DQ and VL.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// Environment variable with the widest set to use, `portable` or `avx2`: the machine's own set by default.
pub const WIDEST: &str = "FCM_SOLVE_VECTORS";

impl InstructionSet {
    /// Widest set of this machine, up to the one that [`WIDEST`] names when this is first called.
    #[inline]
    pub fn detect() -> Self {
        static USED: OnceLock<InstructionSet> = OnceLock::new();
        *USED.get_or_init(|| Self::widest_up_to(std::env::var(WIDEST).ok().as_deref()))
    }

    /// Widest set of this machine up to the one of a name. Unknown names stand for no limit.
    #[cfg(target_arch = "x86_64")]
    fn widest_up_to(name: Option<&str>) -> Self {
        let is_portable = name == Some("portable");
        if x86::has_avx512() && !is_portable && name != Some("avx2") {
            Self::Avx512
        } else if x86::has_avx2() && !is_portable {
            Self::Avx2
        } else {
            Self::Portable
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn widest_up_to(_: Option<&str>) -> Self {
        Self::Portable
    }
}

/// Prefetches the cache line of an address, which need not be valid.
#[inline(always)]
pub fn prefetch<T>(address: *const T) {
    // SAFETY: a prefetch reads nothing.
    #[cfg(target_arch = "x86_64")]
    unsafe {
        std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(address.cast());
    }
}

/// Runs `work` compiled for the widest vectors of this machine. Its loops are vectorised like any others, but with
/// wider registers and fused `mul_add`. Write `vectorised(#[inline(always)] || ...)`; functions that it calls have to
/// be inlined as well, or they stay compiled for any processor.
pub fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    match InstructionSet::detect() {
        InstructionSet::Portable => work(),
        // SAFETY: the machine has these instructions.
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx2 => unsafe { x86::avx2(work) },
        // SAFETY: the machine has these instructions.
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx512 => unsafe { x86::avx512(work) },
    }
}

#[cfg(test)]
mod tests;
