//! Complex transforms of columns, as many at once as a vector has lanes.

use super::butterfly::{Butterfly, ComplexLanes};
use super::{Direction, root_of_unity};
use crate::Real;
use num_complex::Complex;
use simd::{SimdVector, VectorKernel, prefetch};

/// Plan for columns of `n` elements: Stockham passes of radix 8, 4, 2, 3, 5, 7, which end in natural order. Neither
/// direction scales. Element `i` of the columns is a vector of real parts followed by one of imaginary parts.
pub(crate) struct ColumnPlan<T> {
    length: usize,
    passes: Vec<StockhamPass<T>>,
}

/// One pass: `s x m` butterflies of `radix` elements,
/// `y[q + s (radix p + j)] = exp(-2 pi i p j / (radix m)) sum_k x[q + s (p + m k)] exp(-2 pi i j k / radix)`.
struct StockhamPass<T> {
    radix: usize,
    m: usize,
    s: usize,
    /// `exp(-2 pi i p j / (radix m))` for j = 1 to radix - 1 of each p >= 1; none in the last pass, where m = 1.
    twiddles: Vec<Complex<T>>,
}

/// Position of columns in memory, and the distance in values from one element to the next.
#[derive(Clone, Copy)]
pub(crate) struct StridedPointer<T> {
    pub first: *mut T,
    pub stride: usize,
}

impl<T: Real> ColumnPlan<T> {
    pub fn new(length: usize) -> Self {
        let mut passes = Vec::new();
        let (mut rest, mut s) = (length, 1);
        for radix in radices(length) {
            let m = rest / radix;
            let twiddle = |p: usize| (1..radix).map(move |j| root_of_unity(p * j, radix * m));
            let twiddles = (1..m).flat_map(twiddle).collect();
            passes.push(StockhamPass { radix, m, s, twiddles });
            (rest, s) = (m, s * radix);
        }
        Self { length, passes }
    }

    pub fn length(&self) -> usize {
        self.length
    }

    /// Transforms the columns at `from` into those at `to`, which may be the same.
    ///
    /// # Safety
    /// The `length` elements at `from` can be read, those at `to` written, with no concurrent access; each of the two
    /// buffers has room for as many.
    pub unsafe fn run(
        &self,
        direction: Direction,
        from: StridedPointer<T>,
        to: StridedPointer<T>,
        buffers: [*mut T; 2],
    ) {
        let parts = match direction {
            Direction::Forward => [0, T::LANES],
            Direction::Backward => [T::LANES, 0],
        };
        let buffers = buffers.map(|first| StridedPointer { first, stride: 2 * T::LANES });
        let mut source = from;
        for (i, pass) in self.passes.iter().enumerate() {
            let target = if i + 1 == self.passes.len() { to } else { buffers[i % 2] };
            // SAFETY: guaranteed by the caller; source and target are distinct, unless a single pass works in place,
            // which one butterfly can.
            unsafe { pass.run(source, target, parts) };
            source = target;
        }
        if self.passes.is_empty() {
            // SAFETY: guaranteed by the caller.
            unsafe { std::ptr::copy(from.first, to.first, 2 * T::LANES) };
        }
    }
}

/// Factors of a length, few and small ones first: a pass multiplies `1 - 1/radix` of its elements by roots of unity,
/// but the last one multiplies none.
fn radices(length: usize) -> Vec<usize> {
    let (mut rest, mut found) = (length, Vec::new());
    for prime in [7, 5, 3] {
        while rest.is_multiple_of(prime) {
            found.push(prime);
            rest /= prime;
        }
    }
    while rest > 1 {
        let radix = if rest.is_multiple_of(8) { 8 } else { rest.min(4) };
        found.push(radix);
        rest /= radix;
    }
    found.sort_unstable();
    found
}

impl<T: Real> StockhamPass<T> {
    unsafe fn run(&self, from: StridedPointer<T>, to: StridedPointer<T>, parts: [usize; 2]) {
        let far_apart = from.stride > 2 * T::LANES;
        match self.radix {
            2 => T::dispatch(Butterflies::<T, 2> { pass: self, from, to, parts, far_apart }),
            3 => T::dispatch(Butterflies::<T, 3> { pass: self, from, to, parts, far_apart }),
            4 => T::dispatch(Butterflies::<T, 4> { pass: self, from, to, parts, far_apart }),
            5 => T::dispatch(Butterflies::<T, 5> { pass: self, from, to, parts, far_apart }),
            7 => T::dispatch(Butterflies::<T, 7> { pass: self, from, to, parts, far_apart }),
            8 => T::dispatch(Butterflies::<T, 8> { pass: self, from, to, parts, far_apart }),
            radix => unreachable!("no pass of radix {radix} is planned"),
        }
    }
}

struct Butterflies<'a, T, const R: usize> {
    pass: &'a StockhamPass<T>,
    from: StridedPointer<T>,
    to: StridedPointer<T>,
    parts: [usize; 2],
    /// Whether this pass reads elements that lie far apart; it then prefetches those of the next columns, which are
    /// probably transformed next.
    far_apart: bool,
}

macro_rules! work {
    ($($radix:literal)*) => {$(
        impl<T: Real> VectorKernel<T> for Butterflies<'_, T, $radix> {
            type Output = ();

            #[inline(always)]
            fn run<V: SimdVector<T>>(self) {
                // SAFETY: guaranteed by the caller of `ColumnPlan::run`.
                unsafe { self.all::<V>() }
            }
        }
    )*};
}

work!(2 3 4 5 7 8);

impl<T: Real, const R: usize> Butterflies<'_, T, R> {
    #[inline(always)]
    unsafe fn all<V: SimdVector<T>>(&self)
    where
        [ComplexLanes<V, T>; R]: Butterfly,
    {
        let &StockhamPass { m, s, ref twiddles, .. } = self.pass;
        for q in 0..s {
            // SAFETY: all elements are below the length R m s.
            unsafe { self.one::<V>([q, s * m], [q, s], None) };
        }
        for (p, roots) in (1..).zip(twiddles.chunks_exact(R - 1)) {
            for q in 0..s {
                // SAFETY: all elements are below the length R m s.
                unsafe { self.one::<V>([q + s * p, s * m], [q + s * R * p, s], Some(roots)) };
            }
        }
    }

    /// Reads elements, transforms them, multiplies all but the first by a root of unity, and writes them;
    /// `[first, distance]` select the elements.
    #[inline(always)]
    unsafe fn one<V: SimdVector<T>>(&self, source: [usize; 2], target: [usize; 2], roots: Option<&[Complex<T>]>)
    where
        [ComplexLanes<V, T>; R]: Butterfly,
    {
        if self.far_apart {
            for k in 0..R {
                let next = (source[0] + k * source[1]) * self.from.stride + 2 * T::LANES;
                prefetch(self.from.first.wrapping_add(next));
                prefetch(self.from.first.wrapping_add(next + T::LANES));
            }
        }
        // SAFETY: guaranteed by the caller.
        let read = |k: usize| unsafe {
            ComplexLanes::<V, T>::load(self.from.first.add((source[0] + k * source[1]) * self.from.stride), self.parts)
        };
        let mut values = [read(0); R];
        for (k, value) in values.iter_mut().enumerate().skip(1) {
            *value = read(k);
        }
        let values = values.transform();
        for j in 0..R {
            let mut value = values[j];
            if let Some(roots) = roots
                && j > 0
            {
                value = value.mul(ComplexLanes::new(V::splat(roots[j - 1].re), V::splat(roots[j - 1].im)));
            }
            let place = (target[0] + j * target[1]) * self.to.stride;
            // SAFETY: guaranteed by the caller.
            unsafe { value.store(self.to.first.add(place), self.parts) };
        }
    }
}
