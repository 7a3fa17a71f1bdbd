//! Spreading: loads to force density.

use crate::grid::kernel::{Kernel, Load, Slab, SphereStencil};
use crate::grid::stencil::Stencil;
use domain::parallel::{self, MeasuredLoop};
use rayon::prelude::*;
use simd::{SimdVector as Lanes, VectorKernel};
use solver::{Field, Physical, Real};

/// Sources of the spreading: stencils, and the class and load of each particle present.
pub(crate) struct Spread<'a, T, const C: usize = 3> {
    pub stencils: &'a [Stencil],
    pub classes: &'a [u32],
    pub loads: &'a [Load<T, C>],
    /// Number of planes of the grid.
    pub period: usize,
}

impl<T: Real, const C: usize> Spread<'_, T, C> {
    /// Sets the field to the sum of all loads. Each thread writes its own planes and processes the particles in the
    /// same order, so the sums do not depend on the number of threads.
    pub fn run<K: Kernel<T, C>>(&self, kernel: &K, field: &mut Field<T, Physical, C>) {
        let [lines, planes] = field.rows();
        if lines.is_empty() || planes.is_empty() {
            return;
        }
        let strides = [field.row_stride(), field.plane_stride()];
        let bytes = 2 * C * strides[1] * planes.len() * size_of::<T>();
        let thickness = planes.len().div_ceil(parallel::parts());
        let mut rest = field.components_mut().map(|component| component.chunks_mut(strides[1] * thickness));
        let part = |_| rest.each_mut().map(|component| component.next().expect("components have equal sizes"));
        let parts: Vec<[&mut [T]; C]> = (0..planes.len().div_ceil(thickness)).map(part).collect();
        parts.into_par_iter().enumerate().moving(bytes).for_each(|(part, components)| {
            let start = planes.start + part * thickness;
            let planes = start..planes.end.min(start + thickness);
            let slab = Slab { components, lines: lines.clone(), planes, strides };
            T::dispatch(Fill { spread: self, kernel, slab });
        });
    }
}

/// One thread's part.
struct Fill<'a, T, K, const C: usize> {
    spread: &'a Spread<'a, T, C>,
    kernel: &'a K,
    slab: Slab<&'a mut [T], C>,
}

impl<T: Real, const C: usize, K: Kernel<T, C>> VectorKernel<T> for Fill<'_, T, K, C> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(mut self) {
        let Spread { stencils, classes, loads, period } = self.spread;
        let planes = self.kernel.planes();
        let mut scratch = K::Scratch::default();
        let mut dirty = Dirty::all(self.slab.planes.len());
        for stencil in *stencils {
            let row = stencil.row as usize;
            dirty.clear_for(stencil, planes, *period, &mut self.slab);
            let sphere = SphereStencil { stencil, class: classes[row] };
            self.kernel.deposit::<V>(&mut scratch, sphere, &loads[row], &mut self.slab);
        }
        dirty.clear_rest(&mut self.slab);
    }
}

/// Planes of a slab that still hold old values. They are zeroed when a stencil first needs them, so that they are in
/// the cache then.
struct Dirty {
    planes: Vec<bool>,
    /// First plane of the last stencil.
    last: Option<u32>,
}

impl Dirty {
    fn all(planes: usize) -> Self {
        Self { planes: vec![true; planes], last: None }
    }

    /// Zeroes the planes that a stencil of `count` planes touches, wrapped at the period.
    #[inline(always)]
    fn clear_for<T: Real, const C: usize>(
        &mut self,
        stencil: &Stencil,
        count: usize,
        period: usize,
        slab: &mut Slab<&mut [T], C>,
    ) {
        if self.last == Some(stencil.first[2]) {
            return;
        }
        self.last = Some(stencil.first[2]);
        for point in 0..count {
            let plane = (stencil.first[2] as usize + point) % period;
            if slab.planes.contains(&plane) {
                self.clear(plane - slab.planes.start, slab);
            }
        }
    }

    fn clear_rest<T: Real, const C: usize>(&mut self, slab: &mut Slab<&mut [T], C>) {
        for plane in 0..self.planes.len() {
            self.clear(plane, slab);
        }
    }

    fn clear<T: Real, const C: usize>(&mut self, plane: usize, slab: &mut Slab<&mut [T], C>) {
        if std::mem::take(&mut self.planes[plane]) {
            let size = slab.strides[1];
            for component in &mut slab.components {
                component[plane * size..(plane + 1) * size].fill(T::default());
            }
        }
    }
}
