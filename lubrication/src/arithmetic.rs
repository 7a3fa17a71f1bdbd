//! Numbers of one pair or of several.

use std::ops::{Add, Mul, Sub};

/// Numbers that the resistance of pairs is computed in: one at a time, or as many as a vector of the machine has.
///
/// What computes with them is inlined, to be compiled for the vectors of its caller.
pub trait Arithmetic: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// Numbers in it.
    const WIDTH: usize;

    /// The same number throughout.
    fn constant(value: f64) -> Self;

    /// `self + factor * term`, rounded once.
    #[must_use]
    fn plus(self, factor: Self, term: Self) -> Self;

    /// `self / divisor`
    #[must_use]
    fn over(self, divisor: Self) -> Self;

    /// The first numbers of some.
    fn read(from: &[f64]) -> Self;

    /// Writes itself to the first places of some.
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
