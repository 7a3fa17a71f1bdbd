//! Loads to force density.

use crate::kernel::{Lattice, Scratch, Slab, deposit};
use crate::shape::{Load, Shape, Sources};
use crate::stencil::Place;
use rayon::prelude::*;
use solver::simd::{Vector as Lanes, Work};
use solver::{Field, Physical, Real};
use std::marker::PhantomData;

/// What is spread: stencils, and for each particle present its class and load.
pub(crate) struct Spread<'a, T> {
    pub places: &'a [Place],
    pub classes: &'a [u32],
    pub sources: &'a [Sources],
    pub loads: &'a [Load<T>],
    pub lattice: &'a Lattice,
}

impl<T: Real> Spread<'_, T> {
    /// Makes the field the sum of all loads. Each thread writes planes of its own and goes through the particles in the same
    /// order, so that the sums do not depend on the number of threads.
    pub fn run<S: Shape>(&self, field: &mut Field<T, Physical>) {
        let [lines, planes] = field.rows();
        if lines.is_empty() || planes.is_empty() {
            return;
        }
        let strides = [field.row_stride(), field.plane_stride()];
        let thickness = planes.len().div_ceil(rayon::current_num_threads());
        let [x, y, z] = field.components_mut().map(|c| c.par_chunks_mut(strides[1] * thickness));
        x.zip(y).zip(z).enumerate().for_each(|(part, ((x, y), z))| {
            let start = planes.start + part * thickness;
            let planes = start..planes.end.min(start + thickness);
            let slab = Slab { components: [x, y, z], lines: lines.clone(), planes, strides };
            T::dispatch(Fill::<T, S> { spread: self, slab, shape: PhantomData });
        });
    }
}

/// One thread's part.
struct Fill<'a, T, S> {
    spread: &'a Spread<'a, T>,
    slab: Slab<&'a mut [T]>,
    shape: PhantomData<S>,
}

impl<T: Real, S: Shape> Work<T> for Fill<'_, T, S> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(mut self) {
        let Spread { places, classes, sources, loads, lattice } = self.spread;
        let mut scratch = Scratch::default();
        let mut dirty = Dirty::all(self.slab.planes.len());
        for place in *places {
            let row = place.row as usize;
            let particle = (place, &sources[classes[row] as usize], &loads[row]);
            dirty.clear_for(place, lattice, &mut self.slab);
            deposit::<T, S, V>(&mut scratch, particle, lattice, &mut self.slab);
        }
        dirty.clear_rest(&mut self.slab);
    }
}

/// The planes of a slab that still hold old values. They are set to zero when a stencil first needs them, so that they
/// are in the cache when it does.
struct Dirty {
    planes: Vec<bool>,
    /// First plane of the last stencil.
    last: Option<u32>,
}

impl Dirty {
    fn all(planes: usize) -> Self {
        Self { planes: vec![true; planes], last: None }
    }

    /// Clears the planes that a stencil touches.
    #[inline(always)]
    fn clear_for<T: Real>(&mut self, place: &Place, lattice: &Lattice, slab: &mut Slab<&mut [T]>) {
        if self.last == Some(place.first[2]) {
            return;
        }
        self.last = Some(place.first[2]);
        for point in 0..lattice.support.support {
            let plane = (place.first[2] as usize + point) % lattice.points[2];
            if slab.planes.contains(&plane) {
                self.clear(plane - slab.planes.start, slab);
            }
        }
    }

    fn clear_rest<T: Real>(&mut self, slab: &mut Slab<&mut [T]>) {
        for plane in 0..self.planes.len() {
            self.clear(plane, slab);
        }
    }

    fn clear<T: Real>(&mut self, plane: usize, slab: &mut Slab<&mut [T]>) {
        if std::mem::take(&mut self.planes[plane]) {
            let size = slab.strides[1];
            for component in &mut slab.components {
                component[plane * size..(plane + 1) * size].fill(T::default());
            }
        }
    }
}
