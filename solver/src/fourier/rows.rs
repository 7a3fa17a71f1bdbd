//! Real transforms of rows, as many at once as a vector has lanes.

use super::butterfly::ComplexLanes;
use super::columns::StridedPointer;
use super::{AnyLength, Direction, root_of_unity};
use crate::Real;
use num_complex::Complex;
use simd::{SimdVector, StridedRows, VectorKernel, prefetch};

/// Plan for rows of `n` real values and their `n/2` coefficients `0 <= k < n/2`; the coefficient `n/2` is dropped,
/// and taken as zero in the backward direction. Neither direction scales.
///
/// A row of coefficients consists of blocks: the real parts of [`Real::LANES`] neighbours, then their imaginary
/// parts; the last block is padded with zeros.
///
/// Pairs of values are transformed as complex numbers, `z_j = x_2j + i x_2j+1`, and
/// `X_k = (Z_k + Z*_h-k)/2 - i/2 exp(-2 pi i k / n) (Z_k - Z*_h-k)` with `h = n/2`.
pub(crate) struct RowPlan<T> {
    half: AnyLength<T>,
    /// `-i/2 exp(-2 pi i k / n)`
    roots: Vec<Complex<T>>,
    halo: usize,
}

impl<T: Real> RowPlan<T> {
    /// Plan for rows of twice the length that `half` transforms, with halos.
    pub fn new(half: AnyLength<T>, halo: usize) -> Self {
        let length = 2 * half.length();
        let root = |k: usize| {
            let w: Complex<T> = root_of_unity(k, length);
            let half = T::from_f64(0.5);
            Complex::new(w.im * half, -(w.re * half))
        };
        Self { roots: (0..length / 2).map(root).collect(), half, halo }
    }

    /// Number of values that each buffer needs to hold.
    pub fn room(&self) -> usize {
        (self.blocks() * T::LANES * 2 * T::LANES).max(self.half.room())
    }

    fn blocks(&self) -> usize {
        self.half.length().div_ceil(T::LANES)
    }

    /// Transforms [`Real::LANES`] rows in place: forward after adding the halos to the rows' starts, or backward
    /// before filling the halos.
    ///
    /// # Safety
    /// The rows can be read and written up to their stride, which is a multiple of [`Real::LANES`] and has room for
    /// values, halo and blocks, with no concurrent access; each buffer has [`Self::room`].
    pub unsafe fn run(&self, direction: Direction, rows: StridedRows<*mut T>, [values, first, second]: [*mut T; 3]) {
        let columns = StridedPointer { first: values, stride: 2 * T::LANES };
        let transform = || {
            // SAFETY: the buffers have room for half as many complex elements.
            unsafe { self.half.run(direction, columns, columns, [first, second]) };
        };
        match direction {
            Direction::Forward => {
                T::dispatch(Gather { plan: self, rows, values });
                transform();
                T::dispatch(ToSpectrum { plan: self, rows, values });
            }
            Direction::Backward => {
                T::dispatch(FromSpectrum { plan: self, rows, values });
                transform();
                T::dispatch(Scatter { plan: self, rows, values });
            }
        }
    }
}

/// Adds the halos, and transposes values into lanes.
struct Gather<'a, T> {
    plan: &'a RowPlan<T>,
    rows: StridedRows<*mut T>,
    values: *mut T,
}

impl<T: Real> VectorKernel<T> for Gather<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector<T>>(self) {
        let Self { plan, rows, values } = self;
        let length = 2 * plan.half.length();
        for r in 0..T::LANES {
            // SAFETY: a row has room for its values and its halo.
            let row = unsafe { std::slice::from_raw_parts_mut(rows.first.add(r * rows.stride), length + plan.halo) };
            let (row, halo) = row.split_at_mut(length);
            for turn in halo.chunks(length) {
                for (value, extra) in row.iter_mut().zip(turn) {
                    *value += *extra;
                }
            }
        }
        for x in (0..length).step_by(T::LANES) {
            // Prefetches the next batch.
            for r in T::LANES..2 * T::LANES {
                prefetch(rows.first.wrapping_add(r * rows.stride + x));
            }
            // SAFETY: rows and buffer have room up to the next multiple of the lanes.
            unsafe {
                V::transpose(
                    rows.from_column(x).cast_const(),
                    StridedRows { first: values.add(x * T::LANES), stride: T::LANES },
                );
            }
        }
    }
}

/// Transposes values back into rows, and fills the halos.
struct Scatter<'a, T> {
    plan: &'a RowPlan<T>,
    rows: StridedRows<*mut T>,
    values: *mut T,
}

impl<T: Real> VectorKernel<T> for Scatter<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector<T>>(self) {
        let Self { plan, rows, values } = self;
        let length = 2 * plan.half.length();
        for x in (0..length).step_by(T::LANES) {
            // SAFETY: rows and buffer have room up to the next multiple of the lanes.
            unsafe {
                V::transpose(
                    StridedRows { first: values.add(x * T::LANES).cast_const(), stride: T::LANES },
                    rows.from_column(x),
                );
            }
        }
        for r in 0..T::LANES {
            // SAFETY: a row has room for its values and its halo.
            let row = unsafe { std::slice::from_raw_parts_mut(rows.first.add(r * rows.stride), length + plan.halo) };
            let (row, halo) = row.split_at_mut(length);
            for turn in halo.chunks_mut(length) {
                turn.copy_from_slice(&row[..turn.len()]);
            }
        }
    }
}

/// Converts the transform of the pairs to coefficients, and writes these into blocks of the rows.
struct ToSpectrum<'a, T> {
    plan: &'a RowPlan<T>,
    rows: StridedRows<*mut T>,
    values: *mut T,
}

impl<T: Real> VectorKernel<T> for ToSpectrum<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector<T>>(self) {
        let Self { plan, rows, values } = self;
        let h = plan.half.length();
        let half = V::splat(T::from_f64(0.5));
        // SAFETY: all elements lie inside the buffer and the rows.
        unsafe {
            let zero = V::splat(T::default());
            let first = element::<T, V>(values, 0);
            put(values, 0, ComplexLanes::new(first.re.add(first.im), zero));
            for k in 1..=h / 2 {
                let (a, b) = (element::<T, V>(values, k), element::<T, V>(values, h - k));
                let sum = ComplexLanes::<V, T>::new(a.re.add(b.re).mul(half), a.im.sub(b.im).mul(half));
                let turned = root::<T, V>(plan.roots[k]).mul(ComplexLanes::new(a.re.sub(b.re), a.im.add(b.im)));
                put(values, h - k, conjugate(sum.sub(turned)));
                put(values, k, sum.add(turned));
            }
            for k in h..plan.blocks() * T::LANES {
                put(values, k, ComplexLanes::new(zero, zero));
            }
            for part in 0..2 * plan.blocks() {
                let from = values.add((part / 2) * 2 * T::LANES * T::LANES + (part % 2) * T::LANES);
                V::transpose(StridedRows { first: from, stride: 2 * T::LANES }, rows.from_column(part * T::LANES));
            }
        }
    }
}

/// Converts the blocks of the rows to the input of the backward transform of the pairs.
struct FromSpectrum<'a, T> {
    plan: &'a RowPlan<T>,
    rows: StridedRows<*mut T>,
    values: *mut T,
}

impl<T: Real> VectorKernel<T> for FromSpectrum<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector<T>>(self) {
        let Self { plan, rows, values } = self;
        let h = plan.half.length();
        let two = V::splat(T::from_f64(2.0));
        // SAFETY: all elements lie inside the buffer and the rows.
        unsafe {
            for part in 0..2 * plan.blocks() {
                let to = values.add((part / 2) * 2 * T::LANES * T::LANES + (part % 2) * T::LANES);
                V::transpose(
                    rows.from_column(part * T::LANES).cast_const(),
                    StridedRows { first: to, stride: 2 * T::LANES },
                );
            }
            let first = element::<T, V>(values, 0);
            put(values, 0, ComplexLanes::new(first.re, first.re));
            for k in 1..=h / 2 {
                let (a, b) = (element::<T, V>(values, k), element::<T, V>(values, h - k));
                let sum = ComplexLanes::<V, T>::new(a.re.add(b.re), a.im.sub(b.im));
                let difference = ComplexLanes::<V, T>::new(a.re.sub(b.re).mul(two), a.im.add(b.im).mul(two));
                // 2 conj(-i/2 w^k) = i w^-k
                let turned = conjugate(root::<T, V>(plan.roots[k])).mul(difference);
                put(values, h - k, conjugate(sum.sub(turned)));
                put(values, k, sum.add(turned));
            }
        }
    }
}

#[inline(always)]
fn root<T: Real, V: SimdVector<T>>(root: Complex<T>) -> ComplexLanes<V, T> {
    ComplexLanes::new(V::splat(root.re), V::splat(root.im))
}

#[inline(always)]
fn conjugate<T: Real, V: SimdVector<T>>(value: ComplexLanes<V, T>) -> ComplexLanes<V, T> {
    ComplexLanes::new(value.re, V::splat(T::default()).sub(value.im))
}

#[inline(always)]
unsafe fn element<T: Real, V: SimdVector<T>>(values: *mut T, index: usize) -> ComplexLanes<V, T> {
    // SAFETY: guaranteed by the caller.
    unsafe { ComplexLanes::load(values.add(index * 2 * T::LANES), [0, T::LANES]) }
}

#[inline(always)]
unsafe fn put<T: Real, V: SimdVector<T>>(values: *mut T, index: usize, value: ComplexLanes<V, T>) {
    // SAFETY: guaranteed by the caller.
    unsafe { value.store(values.add(index * 2 * T::LANES), [0, T::LANES]) };
}
