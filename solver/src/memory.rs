//! Memory aligned to cache lines.

use crate::Real;
use bytemuck::{Pod, Zeroable};
use std::marker::PhantomData;

/// Values aligned to a cache line of 64 bytes, so that no [`simd::SimdVector`] straddles two.
#[derive(Debug, Clone, Default)]
pub struct AlignedMemory<T> {
    lines: Vec<AlignedLine>,
    values: PhantomData<T>,
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct AlignedLine([u64; 8]);

impl<T: Real> AlignedMemory<T> {
    /// At least `count` zeros.
    pub fn zero(count: usize) -> Self {
        Self { lines: vec![AlignedLine::zeroed(); count.div_ceil(T::LANES)], values: PhantomData }
    }

    /// Makes room for at least `count` values; existing ones are kept.
    pub fn resize(&mut self, count: usize) {
        self.lines.resize(count.div_ceil(T::LANES), AlignedLine::zeroed());
    }

    /// The values.
    pub fn values(&self) -> &[T] {
        bytemuck::cast_slice(&self.lines)
    }

    /// The values, mutably.
    pub fn values_mut(&mut self) -> &mut [T] {
        bytemuck::cast_slice_mut(&mut self.lines)
    }
}
