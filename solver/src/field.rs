//! Values on the grid, with a type parameter for physical or Fourier space.

use crate::layout::{Layout, ModeRows};
use crate::modes::{Complexes, MODES};
use crate::shared::Shared;
use crate::{Real, memory::AlignedMemory};
use domain::parallel::MeasuredLoop;
use num_complex::Complex;
use rayon::prelude::*;
use std::marker::PhantomData;
use std::ops::Range;

/// Marker for values at grid points.
#[derive(Debug, Clone, Copy)]
pub enum Physical {}

/// Marker for Fourier coefficients.
#[derive(Debug, Clone, Copy)]
pub enum Spectral {}

/// One rank's share of a field with `C` components, three of a vector field, made by [`crate::Transform::field`].
///
/// In physical space a rank owns whole rows along x. After the `nx` values of each row there is room for `halo` more,
/// so that a stencil that crosses the end of the box continues without wrapping. Values written there belong to the
/// start of the row: a forward transform adds them to it, and a backward transform copies the row's start there.
#[derive(Debug, Clone)]
pub struct Field<T, Space, const C: usize = 3> {
    pub(crate) memory: AlignedMemory<T>,
    pub(crate) layout: Layout,
    space: PhantomData<Space>,
}

impl<T: Real, Space, const C: usize> Field<T, Space, C> {
    pub(crate) fn zero(layout: &Layout) -> Self {
        Self { memory: AlignedMemory::zero(layout.capacity), layout: layout.clone(), space: PhantomData }
    }

    /// Reinterprets the memory as values in another space.
    pub(crate) fn into_space<Other>(self) -> Field<T, Other, C> {
        Field { memory: self.memory, layout: self.layout, space: PhantomData }
    }

    /// Points of the whole grid along x, y and z.
    pub fn points(&self) -> [usize; 3] {
        self.layout.points
    }

    /// Sets every value to zero, halos included.
    pub fn clear(&mut self) {
        self.memory.values_mut().par_chunks_mut(1 << 15).measured().for_each(|part| part.fill(T::default()));
    }
}

impl<T: Real, const C: usize> Field<T, Physical, C> {
    /// Ranges of rows along y and along z that this rank owns.
    pub fn rows(&self) -> [Range<usize>; 2] {
        self.layout.rows.clone()
    }

    /// Length of the halo after the `nx` values of each row.
    pub fn halo(&self) -> usize {
        self.layout.halo
    }

    /// Distance from one row to the next along y in [`Self::components`].
    pub fn row_stride(&self) -> usize {
        self.layout.physical.y
    }

    /// Distance from one row to the next along z in [`Self::components`].
    pub fn plane_stride(&self) -> usize {
        self.layout.physical.z
    }

    /// All values of each component: the row at `y` and `z` begins at
    /// `(z - rows[1].start) * plane_stride + (y - rows[0].start) * row_stride`.
    pub fn components(&self) -> [&[T]; C] {
        let (size, stride) = (self.component_size(), self.layout.physical.component);
        std::array::from_fn(|c| &self.memory.values()[c * stride..c * stride + size])
    }

    /// All values of each component, mutably.
    pub fn components_mut(&mut self) -> [&mut [T]; C] {
        let (size, stride) = (self.component_size(), self.layout.physical.component);
        let mut parts = self.memory.values_mut().chunks_mut(stride);
        std::array::from_fn(|_| &mut parts.next().expect("there is room for all components")[..size])
    }

    fn component_size(&self) -> usize {
        self.layout.rows[1].len() * self.layout.physical.z
    }

    /// Row of a component at a `y` and `z` that this rank owns, halo included.
    pub fn row(&self, component: usize, y: usize, z: usize) -> &[T] {
        let row = self.row_range(component, y, z);
        &self.memory.values()[row]
    }

    /// Row of a component, mutably.
    pub fn row_mut(&mut self, component: usize, y: usize, z: usize) -> &mut [T] {
        let row = self.row_range(component, y, z);
        &mut self.memory.values_mut()[row]
    }

    fn row_range(&self, component: usize, y: usize, z: usize) -> Range<usize> {
        let [ys, zs] = &self.layout.rows;
        assert!(ys.contains(&y) && zs.contains(&z), "row ({y}, {z}) is another rank's");
        let start = self.layout.physical.at(component, y - ys.start, z - zs.start);
        start..start + self.layout.points[0] + self.layout.halo
    }

    /// Adds the halos to the starts of the rows, as a forward transform does, and clears the halos.
    pub fn fold_halo(&mut self) {
        let (nx, halo) = (self.layout.points[0], self.layout.halo);
        self.for_each_row(|row| {
            let (values, beyond) = row.split_at_mut(nx);
            for turn in beyond[..halo].chunks_mut(nx) {
                for (value, extra) in values.iter_mut().zip(turn) {
                    *value += std::mem::take(extra);
                }
            }
        });
    }

    /// Copies the starts of the rows to the halos, as a backward transform does.
    pub fn fill_halo(&mut self) {
        let (nx, halo) = (self.layout.points[0], self.layout.halo);
        self.for_each_row(|row| {
            let (values, beyond) = row.split_at_mut(nx);
            for turn in beyond[..halo].chunks_mut(nx) {
                turn.copy_from_slice(&values[..turn.len()]);
            }
        });
    }

    /// Sets the halos to zero: before a forward transform of the result of a backward one.
    pub fn clear_halo(&mut self) {
        let (nx, halo) = (self.layout.points[0], self.layout.halo);
        self.for_each_row(|row| row[nx..nx + halo].fill(T::default()));
    }

    fn for_each_row(&mut self, work: impl Fn(&mut [T]) + Sync) {
        let strides = self.layout.physical;
        let rows = self.layout.rows[0].len();
        if rows == 0 {
            return;
        }
        for component in self.components_mut() {
            component
                .par_chunks_mut(strides.z)
                .measured()
                .for_each(|p| p.chunks_exact_mut(strides.y).take(rows).for_each(&work));
        }
    }

    /// Values at this rank's points without halos and padding: `[component][z][y][x]`, x fastest.
    pub fn to_vec(&self) -> Vec<T> {
        let [ys, zs] = self.rows();
        let nx = self.layout.points[0];
        let mut values = Vec::with_capacity(C * nx * ys.len() * zs.len());
        for component in 0..C {
            for z in zs.clone() {
                for y in ys.clone() {
                    values.extend_from_slice(&self.row(component, y, z)[..nx]);
                }
            }
        }
        values
    }

    /// Cuts this rank's rows into tiles of at most `size = [along y, along z]` rows, for threads to write
    /// concurrently: of `ny x nz` tiles, tile `(i, j)` has the index `j * ny + i`.
    pub fn tiles(&mut self, size: [usize; 2]) -> Vec<Tile<'_, T, C>> {
        let (layout, base) = (&self.layout, self.memory.values_mut().as_mut_ptr());
        let cut = |d: usize| {
            let lines = layout.rows[d].clone();
            let end = lines.end;
            lines.step_by(size[d]).map(move |start| start..end.min(start + size[d]))
        };
        cut(1).flat_map(|z| cut(0).map(move |y| [y, z.clone()])).map(|rows| Tile { base, layout, rows }).collect()
    }
}

/// Some rows of a field, written by one thread at a time.
pub struct Tile<'a, T, const C: usize = 3> {
    base: *mut T,
    layout: &'a Layout,
    rows: [Range<usize>; 2],
}

// SAFETY: a tile is made by `Field::tiles` alone, which keeps the field mutably borrowed while any tile lives, and
// gives each row to one tile; `rows_mut` hands out rows of its own tile only.
unsafe impl<T: Real, const C: usize> Send for Tile<'_, T, C> {}
unsafe impl<T: Real, const C: usize> Sync for Tile<'_, T, C> {}

impl<T: Real, const C: usize> Tile<'_, T, C> {
    /// Ranges of rows along y and along z in this tile.
    pub fn rows(&self) -> [Range<usize>; 2] {
        self.rows.clone()
    }

    /// Rows of the components at a `y` and `z` of this tile, halos included.
    pub fn rows_mut(&mut self, y: usize, z: usize) -> [&mut [T]; C] {
        assert!(self.rows[0].contains(&y) && self.rows[1].contains(&z), "row ({y}, {z}) is another tile's");
        let [ys, zs] = &self.layout.rows;
        let length = self.layout.points[0] + self.layout.halo;
        std::array::from_fn(|component| {
            let start = self.layout.physical.at(component, y - ys.start, z - zs.start);
            // SAFETY: the row lies inside the field's memory, belongs to this tile alone, and the components do not
            // overlap.
            unsafe { std::slice::from_raw_parts_mut(self.base.add(start), length) }
        })
    }
}

impl<T: Real, const C: usize> Field<T, Spectral, C> {
    /// Calls `visit(mode, values)` for each mode `[m1, m2, m3]` that this rank owns, `m1 < nx/2`. Over all ranks
    /// these are all modes; those with `m1 > nx/2` are the complex conjugates, and those with `m1 = nx/2` are taken
    /// as zero.
    pub fn for_each_mode(&self, mut visit: impl FnMut([usize; 3], [Complex<T>; C])) {
        let (layout, values) = (&self.layout, self.memory.values());
        for m3 in 0..layout.points[2] {
            let rows = ModeRows { strides: &layout.spectral, modes: &layout.modes, m3 };
            layout.fold_modes_of_plane(rows, |place| values[place], (), |(), mode, values| visit(mode, values));
        }
    }

    /// Sets the values of each mode that this rank owns, as [`Self::for_each_mode`] visits them.
    pub(crate) fn set_modes(&mut self, values: impl Fn([usize; 3]) -> [Complex<f64>; C] + Sync) {
        let most = self.layout.points[0] / 2;
        self.set_blocks(|[first, m2, m3]| {
            let mut block = [[[0.0; MODES]; 2]; C];
            for lane in 0..MODES.min(most - first) {
                for (component, value) in values([first + lane, m2, m3]).into_iter().enumerate() {
                    block[component][0][lane] = value.re;
                    block[component][1][lane] = value.im;
                }
            }
            block
        });
    }

    /// The same, with the values of [`MODES`] consecutive modes along x at once; those that this rank does not own
    /// are left out.
    pub(crate) fn set_blocks(&mut self, values: impl Fn([usize; 3]) -> Complexes<C> + Sync) {
        let (layout, [nx, _, nz]) = (&self.layout, self.layout.points);
        let memory = Shared::new(self.memory.values_mut());
        let end = (layout.blocks.end * T::LANES).min(nx / 2);
        let firsts = (layout.blocks.start * T::LANES..end).step_by(MODES);
        (0..nz).into_par_iter().measured().for_each(|m3| {
            for (m2, first) in layout.modes.clone().flat_map(|m2| firsts.clone().map(move |first| (m2, first))) {
                let block = values([first, m2, m3]);
                for (component, [real, imaginary]) in block.iter().enumerate() {
                    let row = layout.spectral.at(component, m2 - layout.modes.start, m3);
                    for lane in 0..MODES.min(end - first) {
                        let place = row + layout.in_row::<T>(first + lane);
                        // SAFETY: each mode has its own memory, and is set once.
                        unsafe {
                            *memory.at(place) = T::from_f64(real[lane]);
                            *memory.at(place + T::LANES) = T::from_f64(imaginary[lane]);
                        }
                    }
                }
            }
        });
    }
}
