//! Requirements of values on the grid.

use crate::{InstructionSet, SimdVector, VectorKernel};
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
    type Half: SimdVector<Self>;
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
    /// `level` is [`InstructionSet::Portable`] or was found by [`InstructionSet::detect`].
    unsafe fn dispatch_at<W: VectorKernel<Self>>(level: InstructionSet, work: W) -> W::Output;

    /// Runs a kernel with the widest vectors of this machine.
    fn dispatch<W: VectorKernel<Self>>(work: W) -> W::Output {
        // SAFETY: the level is this machine's.
        unsafe { Self::dispatch_at(InstructionSet::detect(), work) }
    }
}
