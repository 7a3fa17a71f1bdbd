//! The two loops in which the program spends its time: a particle's stencil to the grid, and the grid to a particle.

use crate::stencil::Place;
use domain::{Tensor, Vector};
use solver::Real;
use solver::simd::Vector as Lanes;
use std::ops::Range;

/// A way to bring a particle's load to the grid and the grid's velocities to the particle, each the other's adjoint.
pub(crate) trait Kernel<T: Real>: Sync {
    /// What one particle's stencil needs; kept from particle to particle to reuse its memory.
    type Scratch: Default;

    /// Grid points of a stencil along z.
    fn planes(&self) -> usize;

    /// Adds the load of a particle of a class to the rows of a slab.
    fn deposit<V: Lanes<T>>(
        &self,
        scratch: &mut Self::Scratch,
        particle: (&Place, u32, &Load<T>),
        slab: &mut Slab<&mut [T]>,
    );

    /// Weighs the velocities on the rows of a slab as the particle's load was spread.
    fn collect<V: Lanes<T>>(
        &self,
        scratch: &mut Self::Scratch,
        particle: (&Place, u32),
        slab: &Slab<&[T]>,
    ) -> Weighed<T>;
}

/// One particle's force and dipole in the grid's precision: `dipole[c][j] = G_cj`.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Load<T> {
    pub force: [T; 3],
    pub dipole: [[T; 3]; 3],
}

impl<T: Real> Load<T> {
    pub fn new(force: Vector, dipole: &Tensor) -> Self {
        let force = force.to_array().map(T::from_f64);
        let dipole = std::array::from_fn(|c| std::array::from_fn(|j| T::from_f64(dipole.col(j)[c])));
        Self { force, dipole }
    }
}

/// What has been weighed for one particle: the velocity and `gradient[c][j]`, the weight of `G_cj`.
pub(crate) struct Weighed<T> {
    pub velocity: [T; 3],
    pub gradient: [[T; 3]; 3],
}

/// The rows that one thread works on: some planes of this rank's share of the grid.
pub(crate) struct Slab<S> {
    /// The three components of the planes, rows with halos.
    pub components: [S; 3],
    /// The rank's lines along y.
    pub lines: Range<usize>,
    /// The slab's planes.
    pub planes: Range<usize>,
    /// Reals from row to row and from plane to plane.
    pub strides: [usize; 2],
}

/// Where a row or plane of a stencil would begin that is not in the slab.
pub(crate) const ELSEWHERE: usize = usize::MAX;

/// Where the rows of a stencil begin in a plane of a slab, and where its planes begin in the slab.
#[derive(Default)]
pub(crate) struct Starts {
    pub rows: Vec<usize>,
    pub planes: Vec<usize>,
    /// Whether the slab has all of them.
    pub whole: bool,
}

impl Starts {
    /// Those of a stencil of so many rows and planes from the place on. Gives where the last row begins, or nothing if
    /// the slab has none.
    #[inline(always)]
    pub fn find<S>(&mut self, place: &Place, count: usize, points: [usize; 3], slab: &Slab<S>) -> Option<usize> {
        let [_, y, z] = place.first.map(|first| first as usize);
        let planes = starts(&mut self.planes, count, (z, points[2]), &slab.planes, slab.strides[1]);
        if !planes.any {
            return None;
        }
        let rows = starts(&mut self.rows, count, (y, points[1]), &slab.lines, slab.strides[0]);
        self.whole = planes.all && rows.all;
        rows.any.then_some(planes.last + rows.last)
    }

    /// Adds to the rows where they begin along x: at the place's first point, and each `shift` points before the last one, around a
    /// period. Gives the last of these points.
    #[inline(always)]
    pub fn add_columns(&mut self, place: &Place, shift: usize, period: usize) -> usize {
        let (mut x, mut last) = (place.first[0] as usize, 0);
        for start in &mut self.rows {
            if *start != ELSEWHERE {
                *start += x;
                last = last.max(x);
            }
            x = if x < shift { x + period - shift } else { x - shift };
        }
        last
    }
}

/// Which points of a stencil are in a share of them.
struct Found {
    any: bool,
    all: bool,
    last: usize,
}

/// Where the points of a stencil from `first` on, around and around a period, begin in a share of them.
#[inline(always)]
fn starts(
    starts: &mut Vec<usize>,
    count: usize,
    (first, period): (usize, usize),
    share: &Range<usize>,
    stride: usize,
) -> Found {
    starts.resize(count, 0);
    let mut found = Found { any: false, all: true, last: 0 };
    let mut point = first;
    for start in starts.iter_mut() {
        if share.contains(&point) {
            *start = (point - share.start) * stride;
            found.last = found.last.max(*start);
            found.any = true;
        } else {
            *start = ELSEWHERE;
            found.all = false;
        }
        point = if point + 1 == period { 0 } else { point + 1 };
    }
    found
}
