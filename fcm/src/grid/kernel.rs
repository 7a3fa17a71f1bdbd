//! Trait of the two loops that dominate the cost: spreading of a particle's load to the grid, and interpolation from
//! the grid to a particle.

use crate::grid::stencil::Stencil;
use domain::{Tensor, Vector};
use simd::SimdVector as Lanes;
use solver::Real;
use std::ops::Range;

/// Spreading of a particle's load to a grid of `C` components and interpolation of the grid's values to the particle,
/// each the adjoint of the other.
pub(crate) trait Kernel<T: Real, const C: usize = 3>: Sync {
    /// Working memory for one particle's stencil, reused from particle to particle.
    type Scratch: Default;

    /// Number of planes (points along z) of a stencil.
    fn planes(&self) -> usize;

    /// Adds the load of a particle of a class to the rows of a slab.
    fn deposit<V: Lanes<T>>(
        &self,
        scratch: &mut Self::Scratch,
        sphere: SphereStencil,
        load: &Load<T, C>,
        slab: &mut Slab<&mut [T], C>,
    );

    /// Sums the values on the rows of a slab with the weights of the particle's stencil.
    fn collect<V: Lanes<T>>(
        &self,
        scratch: &mut Self::Scratch,
        sphere: SphereStencil,
        slab: &Slab<&[T], C>,
    ) -> WeightedSums<T>;
}

/// Stencil of a sphere, and the class of its radius.
#[derive(Clone, Copy)]
pub(crate) struct SphereStencil<'a> {
    pub stencil: &'a Stencil,
    pub class: u32,
}

/// Force, dipole and degenerate quadrupole of one particle in the grid's precision: `dipole[c][j] = G_cj`. Kernels
/// other than windows ignore the quadrupole. With one component in place of three, a charge and a dipole of charges.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Load<T, const C: usize = 3> {
    pub force: [T; C],
    pub dipole: [[T; 3]; C],
    pub quadrupole: [T; C],
}

impl<T: Real> Load<T> {
    /// Load with a force and a quadrupole, and with a dipole.
    pub fn new(vectors: [Vector; 2], dipole: &Tensor) -> Self {
        let [force, quadrupole] = vectors.map(|vector| vector.to_array().map(T::from_f64));
        let dipole = std::array::from_fn(|c| std::array::from_fn(|j| T::from_f64(dipole.col(j)[c])));
        Self { force, dipole, quadrupole }
    }
}

impl<T: Real> Load<T, 1> {
    /// Charges of a moment `m`, of the density `-m . grad`.
    pub fn of_moment(moment: Vector) -> Self {
        Self { force: [T::default()], dipole: [(-moment).to_array().map(T::from_f64)], quadrupole: [T::default()] }
    }
}

/// Weighted sums for one particle: the velocity and `gradient[c][j]`, the weight of `G_cj`. Of one component, the
/// weights of its first and second derivatives.
pub(crate) struct WeightedSums<T> {
    pub velocity: [T; 3],
    pub gradient: [[T; 3]; 3],
}

/// Rows that one thread works on: some planes of this rank's share of the grid.
pub(crate) struct Slab<S, const C: usize = 3> {
    /// The components of the planes, with halos on the rows.
    pub components: [S; C],
    /// The rank's range of rows along y.
    pub lines: Range<usize>,
    /// Range of planes of the slab.
    pub planes: Range<usize>,
    /// Distance in values from row to row and from plane to plane.
    pub strides: [usize; 2],
}

/// Offset of a row or plane of a stencil that is not in the slab.
pub(crate) const NOT_IN_SLAB: usize = usize::MAX;

/// Offsets of the rows of a stencil in a plane of a slab, and of its planes in the slab.
#[derive(Default)]
pub(crate) struct StencilOffsets {
    pub rows: Vec<usize>,
    pub planes: Vec<usize>,
    /// Whether all rows and planes are in the slab.
    pub whole: bool,
}

impl StencilOffsets {
    /// Finds the offsets of a stencil of `count` rows and planes from `stencil` on. Returns the offset of the last row,
    /// or `None` if no row is in the slab.
    #[inline(always)]
    pub fn find<S, const C: usize>(
        &mut self,
        stencil: &Stencil,
        count: usize,
        points: [usize; 3],
        slab: &Slab<S, C>,
    ) -> Option<usize> {
        let [_, y, z] = stencil.first.map(|first| first as usize);
        let along = |first, axis: usize| StencilAxis { first, count, period: points[axis] };
        let planes = along(z, 2).starts(&mut self.planes, &slab.planes, slab.strides[1]);
        if !planes.any {
            return None;
        }
        let rows = along(y, 1).starts(&mut self.rows, &slab.lines, slab.strides[0]);
        self.whole = planes.all && rows.all;
        rows.any.then_some(planes.last + rows.last)
    }

    /// Adds to each row's offset its first column along x: the stencil's first point, shifted back by `shift` points
    /// from row to row, periodically. Returns the largest of the columns.
    #[inline(always)]
    pub fn add_columns(&mut self, stencil: &Stencil, shift: usize, period: usize) -> usize {
        let (mut x, mut last) = (stencil.first[0] as usize, 0);
        for start in &mut self.rows {
            if *start != NOT_IN_SLAB {
                *start += x;
                last = last.max(x);
            }
            x = if x < shift { x + period - shift } else { x - shift };
        }
        last
    }
}

/// Summary of the points of a stencil that are in a share.
struct StencilSummary {
    any: bool,
    all: bool,
    last: usize,
}

/// The `count` points of a stencil along one axis from `first` on, wrapped at the period.
struct StencilAxis {
    first: usize,
    count: usize,
    period: usize,
}

impl StencilAxis {
    /// Offsets of the points in a share of the grid, `NOT_IN_SLAB` for the others.
    #[inline(always)]
    fn starts(&self, starts: &mut Vec<usize>, share: &Range<usize>, stride: usize) -> StencilSummary {
        starts.resize(self.count, 0);
        let mut found = StencilSummary { any: false, all: true, last: 0 };
        let mut point = self.first;
        for start in starts.iter_mut() {
            if share.contains(&point) {
                *start = (point - share.start) * stride;
                found.last = found.last.max(*start);
                found.any = true;
            } else {
                *start = NOT_IN_SLAB;
                found.all = false;
            }
            point = if point + 1 == self.period { 0 } else { point + 1 };
        }
        found
    }
}
