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
    pub lattice: Lattice,
}

impl<T: Real> Spread<'_, T> {
    /// Adds all loads to the field. Each thread writes planes of its own and goes through the particles in the same
    /// order, so that the sums do not depend on the number of threads.
    pub fn run<S: Shape<K>, const K: usize>(&self, field: &mut Field<T, Physical>) {
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
            T::dispatch(Fill::<T, S, K> { spread: self, slab, shape: PhantomData });
        });
    }
}

/// One thread's part.
struct Fill<'a, T, S, const K: usize> {
    spread: &'a Spread<'a, T>,
    slab: Slab<&'a mut [T]>,
    shape: PhantomData<S>,
}

impl<T: Real, S: Shape<K>, const K: usize> Work<T> for Fill<'_, T, S, K> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(mut self) {
        let Spread { places, classes, sources, loads, lattice } = self.spread;
        let mut scratch = Scratch::default();
        for place in *places {
            let row = place.row as usize;
            let particle = (place, &sources[classes[row] as usize], &loads[row]);
            deposit::<T, S, V, K>(&mut scratch, particle, lattice, &mut self.slab);
        }
    }
}
