//! Complex transforms of columns by rustfft, which needs contiguous rows.

use super::Direction;
use super::columns::StridedPointer;
use crate::Real;
use num_complex::Complex;
use rustfft::{Fft, FftPlanner};
use std::marker::PhantomData;
use std::slice::{from_raw_parts, from_raw_parts_mut};
use std::sync::Arc;

/// Plan for columns of `n` elements: the lanes are gathered into rows, transformed, and scattered again. Neither
/// direction scales. Elements are those of [`super::columns::ColumnPlan`].
///
/// All lanes of a vector are transformed by one call, so each result has the same bits in any lane: if rustfft
/// processes rows in pairs, none is left over.
pub(crate) struct Gathered<T> {
    plan: RustFftPlan,
    real: PhantomData<T>,
}

/// A forward transform of rustfft in one of its two precisions.
enum RustFftPlan {
    Single(Arc<dyn Fft<f32>>),
    Double(Arc<dyn Fft<f64>>),
}

impl<T: Real> Gathered<T> {
    pub fn new(length: usize) -> Self {
        let plan =
            if size_of::<T>() == size_of::<f32>() { RustFftPlan::single(length) } else { RustFftPlan::double(length) };
        Self { plan, real: PhantomData }
    }

    pub fn length(&self) -> usize {
        match &self.plan {
            RustFftPlan::Single(plan) => plan.len(),
            RustFftPlan::Double(plan) => plan.len(),
        }
    }

    /// Number of values that each buffer needs to hold.
    pub fn room(&self) -> usize {
        2 * (T::LANES * self.length()).max(self.plan.scratch())
    }

    /// Transforms the columns at `from` into those at `to`, which may be the same. Backward is forward with real and
    /// imaginary parts exchanged before and after.
    ///
    /// # Safety
    /// The elements at `from` can be read, those at `to` written, with no concurrent access; each of the two buffers
    /// has [`Self::room`].
    pub unsafe fn run(
        &self,
        direction: Direction,
        from: StridedPointer<T>,
        to: StridedPointer<T>,
        [rows, scratch]: [*mut T; 2],
    ) {
        let parts = match direction {
            Direction::Forward => [0, T::LANES],
            Direction::Backward => [T::LANES, 0],
        };
        // SAFETY: guaranteed by the caller; a complex number is two reals.
        unsafe {
            let rows = from_raw_parts_mut(rows.cast::<Complex<T>>(), T::LANES * self.length());
            let scratch = from_raw_parts_mut(scratch.cast::<Complex<T>>(), self.plan.scratch());
            gather(from, rows, parts);
            self.plan.process(rows, scratch);
            scatter(rows, to, parts);
        }
    }
}

impl RustFftPlan {
    // These two are not generic, so that rustfft is compiled here and not again in every crate that plans transforms.
    fn single(length: usize) -> Self {
        Self::Single(FftPlanner::new().plan_fft_forward(length))
    }

    fn double(length: usize) -> Self {
        Self::Double(FftPlanner::new().plan_fft_forward(length))
    }

    /// Complex numbers of scratch memory.
    fn scratch(&self) -> usize {
        match self {
            Self::Single(plan) => plan.get_inplace_scratch_len(),
            Self::Double(plan) => plan.get_inplace_scratch_len(),
        }
    }

    /// Transforms rows in place; `T` is the type of the plan.
    fn process<T: Real>(&self, rows: &mut [Complex<T>], scratch: &mut [Complex<T>]) {
        use bytemuck::cast_slice_mut as cast;
        match self {
            Self::Single(plan) => plan.process_with_scratch(cast(rows), cast(scratch)),
            Self::Double(plan) => plan.process_with_scratch(cast(rows), cast(scratch)),
        }
    }
}

/// Copies columns into rows; `parts` are the offsets of the real and imaginary parts in an element.
///
/// # Safety
/// The elements can be read.
unsafe fn gather<T: Real>(from: StridedPointer<T>, rows: &mut [Complex<T>], [re, im]: [usize; 2]) {
    let length = rows.len() / T::LANES;
    for i in 0..length {
        // SAFETY: guaranteed by the caller.
        let element = unsafe { from_raw_parts(from.first.add(i * from.stride), 2 * T::LANES) };
        for lane in 0..T::LANES {
            rows[lane * length + i] = Complex::new(element[re + lane], element[im + lane]);
        }
    }
}

/// Copies rows into columns.
///
/// # Safety
/// The elements can be written.
unsafe fn scatter<T: Real>(rows: &[Complex<T>], to: StridedPointer<T>, [re, im]: [usize; 2]) {
    let length = rows.len() / T::LANES;
    for i in 0..length {
        // SAFETY: guaranteed by the caller.
        let element = unsafe { from_raw_parts_mut(to.first.add(i * to.stride), 2 * T::LANES) };
        for lane in 0..T::LANES {
            let value = rows[lane * length + i];
            (element[re + lane], element[im + lane]) = (value.re, value.im);
        }
    }
}
