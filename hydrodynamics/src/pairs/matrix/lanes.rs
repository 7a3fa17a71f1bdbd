//! SIMD vectors as scalars of the pair kernels.

use lubrication::Arithmetic;
use simd::{SimdVector, StridedRows};
use std::ops::{Add, Mul, Sub};

/// One number of each of several pairs, one pair per lane.
#[derive(Clone, Copy)]
pub struct SimdLanes<V>(pub V);

/// Number of pairs per SIMD vector.
pub const LANES: usize = 8;

/// Transposition: eight numbers of each record, starting at `first`, become the lanes of eight vectors.
#[inline(always)]
pub fn transpose<V: SimdVector<f64>, const N: usize>(
    records: &[[f64; N]; LANES],
    first: usize,
    lanes: &mut [[f64; LANES]; LANES],
) {
    const { assert!(V::LANES == LANES) };
    assert!(first + LANES <= N, "eight numbers of a record");
    // SAFETY: there are LANES records, `N` numbers apart, and each has eight numbers from `first` on.
    unsafe {
        let rows = StridedRows { first: records.as_ptr().cast::<f64>().add(first), stride: N };
        V::transpose(rows, StridedRows { first: lanes.as_mut_ptr().cast(), stride: LANES });
    }
}

impl<V: SimdVector<f64>> Arithmetic for SimdLanes<V> {
    const WIDTH: usize = LANES;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self(V::splat(value))
    }

    #[inline(always)]
    fn plus(self, factor: Self, term: Self) -> Self {
        Self(factor.0.mul_add(term.0, self.0))
    }

    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        Self(self.0.div(divisor.0))
    }

    #[inline(always)]
    fn read(from: &[f64]) -> Self {
        const { assert!(V::LANES == LANES) };
        let from = &from[..LANES];
        // SAFETY: the slice holds a whole vector.
        Self(unsafe { V::load(from.as_ptr()) })
    }

    #[inline(always)]
    fn write(self, to: &mut [f64]) {
        const { assert!(V::LANES == LANES) };
        let to = &mut to[..LANES];
        // SAFETY: the slice holds a whole vector.
        unsafe { self.0.store(to.as_mut_ptr()) };
    }
}

impl<V: SimdVector<f64>> Add for SimdLanes<V> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0.add(other.0))
    }
}

impl<V: SimdVector<f64>> Sub for SimdLanes<V> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0.sub(other.0))
    }
}

impl<V: SimdVector<f64>> Mul for SimdLanes<V> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0.mul(other.0))
    }
}

/// Storage format of the numbers in the lanes.
pub trait StoredLanes: bytemuck::Zeroable + Copy + Send + Sync {
    /// Loads stored numbers into lanes.
    fn lanes<V: SimdVector<f64>>(stored: &[Self; LANES]) -> SimdLanes<V>;

    /// The stored number.
    fn wide(self) -> f64;

    /// Stores lanes, rounding if necessary.
    fn store<V: SimdVector<f64>>(lanes: SimdLanes<V>, to: &mut [Self; LANES]);
}

impl StoredLanes for f64 {
    #[inline(always)]
    fn lanes<V: SimdVector<f64>>(stored: &[Self; LANES]) -> SimdLanes<V> {
        SimdLanes::read(stored)
    }

    fn wide(self) -> f64 {
        self
    }

    #[inline(always)]
    fn store<V: SimdVector<f64>>(lanes: SimdLanes<V>, to: &mut [Self; LANES]) {
        lanes.write(to);
    }
}

impl StoredLanes for f32 {
    #[inline(always)]
    fn lanes<V: SimdVector<f64>>(stored: &[Self; LANES]) -> SimdLanes<V> {
        SimdLanes::read(&stored.map(f64::from))
    }

    fn wide(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn store<V: SimdVector<f64>>(lanes: SimdLanes<V>, to: &mut [Self; LANES]) {
        let mut wide = [0.0; LANES];
        lanes.write(&mut wide);
        *to = wide.map(|number| number as Self);
    }
}
