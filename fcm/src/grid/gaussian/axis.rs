//! A stencil along one axis.

use crate::grid::gaussian::shape::{GaussianShape, Sources};
use simd::{SimdVector as Lanes, exponential};
use solver::{AlignedMemory, Real};

/// Points of a stencil along one axis: their distances from the particle, and the Gaussians
/// `exp(-distance^2 / (2 width^2))` of the monopole and the dipole, if the shape has them. Padded to whole vectors.
#[derive(Default)]
pub(crate) struct GaussianAxis<T> {
    /// 0, 1, 2, ...
    numbers: AlignedMemory<T>,
    distances: AlignedMemory<T>,
    gaussians: [AlignedMemory<T>; 2],
}

/// Points at the distances `offset + i spacing`, `i < count`, from a particle.
pub(crate) struct AxisPoints {
    pub count: usize,
    pub offset: f64,
    pub spacing: f64,
}

impl<T: Real> GaussianAxis<T> {
    /// Fills in the distances of these points. In the Gaussians, distances are multiplied by `stretch`.
    #[inline(always)]
    pub fn fill<S: GaussianShape, V: Lanes<T>>(
        &mut self,
        AxisPoints { count, offset, spacing }: AxisPoints,
        sources: &Sources,
        stretch: f64,
    ) {
        if self.numbers.values().len() < count {
            self.resize(count);
        }
        let [offset, spacing] = [offset, spacing].map(T::from_f64).map(V::splat);
        let factor = |width: f64| -0.5 * (stretch / width) * (stretch / width);
        let factors = [factor(sources.monopole.width), factor(sources.dipole.width)].map(T::from_f64).map(V::splat);
        let [monopole, dipole] = &mut self.gaussians;
        let chunks =
            self.numbers.values().chunks_exact(V::LANES).zip(self.distances.values_mut().chunks_exact_mut(V::LANES));
        let gaussians =
            monopole.values_mut().chunks_exact_mut(V::LANES).zip(dipole.values_mut().chunks_exact_mut(V::LANES));
        for ((numbers, distances), (monopole, dipole)) in chunks.zip(gaussians) {
            // SAFETY: a chunk has as many values as a vector.
            unsafe {
                let distance = V::load(numbers.as_ptr()).mul_add(spacing, offset);
                distance.store(distances.as_mut_ptr());
                let square = distance.mul(distance);
                if S::FORCES {
                    exponential(square.mul(factors[0])).store(monopole.as_mut_ptr());
                }
                if S::DIPOLES {
                    exponential(square.mul(factors[1])).store(dipole.as_mut_ptr());
                }
            }
        }
    }

    #[inline(never)]
    fn resize(&mut self, count: usize) {
        let [monopole, dipole] = &mut self.gaussians;
        for memory in [&mut self.numbers, &mut self.distances, monopole, dipole] {
            memory.resize(count);
        }
        for (i, number) in self.numbers.values_mut().iter_mut().enumerate() {
            *number = T::from_f64(i as f64);
        }
    }

    /// Distances of the points from the particle.
    #[inline(always)]
    pub fn distances(&self) -> &[T] {
        self.distances.values()
    }

    /// Gaussians of the monopole and of the dipole.
    #[inline(always)]
    pub fn gaussians(&self) -> [&[T]; 2] {
        self.gaussians.each_ref().map(AlignedMemory::values)
    }
}
