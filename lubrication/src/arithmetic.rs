//! Numbers for one pair or for several at once.

use std::ops::{Add, Mul, Sub};

/// Number type of the pair resistances: a single number, or as many as a vector register holds.
///
/// Generic code is inlined, so that it is compiled for the instruction set of its caller.
pub trait Arithmetic: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// Count of numbers in it.
    const WIDTH: usize;

    /// The same value in all lanes.
    fn constant(value: f64) -> Self;

    /// `self + factor * term`, rounded once.
    #[must_use]
    fn plus(self, factor: Self, term: Self) -> Self;

    /// `self / divisor`
    #[must_use]
    fn over(self, divisor: Self) -> Self;

    /// Reads the first numbers of a slice.
    fn read(from: &[f64]) -> Self;

    /// Writes to the first numbers of a slice.
    fn write(self, to: &mut [f64]);
}

impl Arithmetic for f64 {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn plus(self, factor: Self, term: Self) -> Self {
        factor.mul_add(term, self)
    }

    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        self / divisor
    }

    #[inline(always)]
    fn read(from: &[f64]) -> Self {
        from[0]
    }

    #[inline(always)]
    fn write(self, to: &mut [f64]) {
        to[0] = self;
    }
}
