//! The two loops in which the program spends its time: a particle's stencil to the grid, and the grid to a particle.

use crate::axis::Axis;
use crate::shape::{Columns, Load, Plane, Row, Shape, Sources, Sums};
use crate::stencil::{Place, Support};
use domain::Vector;
use solver::simd::Vector as Lanes;
use solver::{Memory, Real};
use std::ops::Range;

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

/// The grid as a stencil sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice {
    pub points: [usize; 3],
    pub spacing: Vector,
    pub support: Support,
}

/// One particle's basis functions on the rows of a slab that it touches; kept from particle to particle to reuse its
/// memory.
#[derive(Default)]
pub(crate) struct Scratch<T> {
    /// The stencil along each axis.
    axes: [Axis<T>; 3],
    /// Touched planes: where each begins, and its point along z.
    planes: Vec<(usize, usize)>,
    /// Touched rows: where each begins in a plane, and its point along y.
    rows: Vec<(usize, usize)>,
    /// Where the last touched row begins in a plane.
    last: usize,
    /// Basis functions: for each vector of columns, each touched row and each function, as many as a vector has lanes.
    basis: Memory<T>,
}

impl<T: Real> Scratch<T> {
    /// Whether the particle touches the slab at all; if so, everything is ready.
    #[inline(always)]
    fn prepare<S: Shape<K>, V: Lanes<T>, X, const K: usize>(
        &mut self,
        (place, sources): (&Place, &Sources),
        lattice: &Lattice,
        slab: &Slab<X>,
    ) -> bool {
        self.find_touched(place, lattice, slab);
        if self.planes.is_empty() || self.rows.is_empty() {
            return false;
        }
        let Support { lanes: columns, support } = lattice.support;
        let (offset, spacing) = (place.offset, lattice.spacing);
        let [x, y, z] = &mut self.axes;
        x.fill(columns, (offset.x, spacing.x), sources, 1.0);
        y.fill(support, (offset.y, spacing.y), sources, sources.strain.mul_add(sources.strain, 1.0).sqrt());
        z.fill(support, (offset.z, spacing.z), sources, 1.0);
        let lanes = T::LANES;
        self.basis.resize(columns * self.rows.len() * K);
        let mut bases = self.basis.values_mut().chunks_exact_mut(K * lanes);
        for from in (0..columns).step_by(lanes) {
            let part = from..from + lanes;
            let columns = [0, 1].map(
                #[inline(always)]
                |kind| Columns {
                    x: &x.distances[part.clone()],
                    gaussian: &x.gaussians[kind][part.clone()],
                    rounded: &x.rounded_gaussians[kind][part.clone()],
                },
            );
            for &(_, point) in &self.rows {
                let row = Row { y: y.distances[point], gaussian: y.gaussian(point) };
                S::basis::<T, V>(sources, columns, row, bases.next().expect("a basis for each row"));
            }
        }
        true
    }

    #[inline(always)]
    fn find_touched<X>(&mut self, place: &Place, lattice: &Lattice, slab: &Slab<X>) {
        self.planes.clear();
        self.rows.clear();
        self.last = 0;
        let [_, lines, planes] = lattice.points;
        for (point, plane) in around(place.first[2], planes).take(lattice.support.support).enumerate() {
            if slab.planes.contains(&plane) {
                self.planes.push(((plane - slab.planes.start) * slab.strides[1], point));
            }
        }
        for (point, line) in around(place.first[1], lines).take(lattice.support.support).enumerate() {
            if slab.lines.contains(&line) {
                let row = (line - slab.lines.start) * slab.strides[0] + place.first[0] as usize;
                self.rows.push((row, point));
                self.last = self.last.max(row);
            }
        }
    }

    /// Where the last touched row of `columns` values ends in the slab.
    #[inline(always)]
    fn end(&self, columns: usize) -> usize {
        let mut plane = 0;
        for &(start, _) in &self.planes {
            plane = plane.max(start);
        }
        plane + self.last + columns
    }

    /// A vector of columns in the plane of a point along z.
    #[inline(always)]
    fn plane<V: Lanes<T>>(&self, from: usize, point: usize) -> Plane<T, V> {
        let [columns, _, heights] = &self.axes;
        let columns = &columns.rounded[from..from + T::LANES];
        // SAFETY: the slice has as many values as a vector.
        let x = unsafe { V::load(columns.as_ptr()) };
        let [monopole, dipole] = heights.gaussian(point);
        Plane { x, z: heights.rounded[point], decay: [T::from_f64(monopole), T::from_f64(dipole)] }
    }
}

/// The points from `first` on, which need not be inside, around and around a period of so many.
#[inline(always)]
fn around(first: i32, points: usize) -> impl Iterator<Item = usize> {
    // Divided once, not at every point.
    let mut next = first.rem_euclid(points as i32) as usize;
    std::iter::repeat_with(
        #[inline(always)]
        move || {
            let point = next;
            next = if point + 1 == points { 0 } else { point + 1 };
            point
        },
    )
}

/// Adds a particle's load to the rows of a slab.
#[inline(always)]
pub(crate) fn deposit<T: Real, S: Shape<K>, V: Lanes<T>, const K: usize>(
    scratch: &mut Scratch<T>,
    (place, sources, load): (&Place, &Sources, &Load<T>),
    lattice: &Lattice,
    slab: &mut Slab<&mut [T]>,
) {
    if !scratch.prepare::<S, V, _, K>((place, sources), lattice, slab) {
        return;
    }
    let (lanes, columns) = (T::LANES, lattice.support.lanes);
    let [x, y, z] = slab.components.each_mut().map(|component| {
        // Checked once a particle, not at every row.
        assert!(scratch.end(columns) <= component.len(), "a stencil ends within its planes");
        component.as_mut_ptr()
    });
    for &(start, point) in &scratch.planes {
        for from in (0..columns).step_by(lanes) {
            let coefficients = S::spread::<T, V>(sources, load, &scratch.plane(from, point));
            let bases = scratch.basis.values()[from * scratch.rows.len() * K..].chunks_exact(K * lanes);
            for (&(row, _), basis) in scratch.rows.iter().zip(bases) {
                let place = start + row + from;
                // SAFETY: a basis has `K` vectors, and `place + lanes` is at most the end that was checked.
                unsafe {
                    let basis = vectors::<T, V, K>(basis);
                    for (component, coefficients) in [x, y, z].into_iter().zip(&coefficients) {
                        let values = component.add(place);
                        let mut sum = V::load(values);
                        for k in 0..K {
                            sum = coefficients[k].mul_add(basis[k], sum);
                        }
                        sum.store(values);
                    }
                }
            }
        }
    }
}

/// The basis functions of one row, in registers: a store to the grid would make the compiler read them again.
///
/// # Safety
/// There are at least `K` vectors of values.
#[inline(always)]
unsafe fn vectors<T: Real, V: Lanes<T>, const K: usize>(basis: &[T]) -> [V; K] {
    let mut vectors = [V::splat(T::default()); K];
    for k in 0..K {
        vectors[k] = unsafe { V::load(basis.as_ptr().add(k * T::LANES)) };
    }
    vectors
}

/// Weighs the velocities on the rows of a slab with a particle's envelopes.
#[inline(always)]
pub(crate) fn collect<T: Real, S: Shape<K>, V: Lanes<T>, const K: usize>(
    scratch: &mut Scratch<T>,
    (place, sources): (&Place, &Sources),
    lattice: &Lattice,
    slab: &Slab<&[T]>,
) -> Sums<V> {
    let zero = V::splat(T::default());
    let mut sums = Sums { velocity: [zero; 3], gradient: [[zero; 3]; 3] };
    if !scratch.prepare::<S, V, _, K>((place, sources), lattice, slab) {
        return sums;
    }
    let (lanes, columns) = (T::LANES, lattice.support.lanes);
    let [x, y, z] = slab.components.map(|component| {
        assert!(scratch.end(columns) <= component.len(), "a stencil ends within its planes");
        component.as_ptr()
    });
    for &(start, point) in &scratch.planes {
        for from in (0..columns).step_by(lanes) {
            let mut moments = [[zero; K]; 3];
            let bases = scratch.basis.values()[from * scratch.rows.len() * K..].chunks_exact(K * lanes);
            for (&(row, _), basis) in scratch.rows.iter().zip(bases) {
                let place = start + row + from;
                // SAFETY: a basis has `K` vectors, and `place + lanes` is at most the end that was checked.
                unsafe {
                    let basis = vectors::<T, V, K>(basis);
                    for (component, moments) in [x, y, z].into_iter().zip(&mut moments) {
                        let values = V::load(component.add(place));
                        for k in 0..K {
                            moments[k] = values.mul_add(basis[k], moments[k]);
                        }
                    }
                }
            }
            S::weigh::<T, V>(sources, &moments, &scratch.plane(from, point), &mut sums);
        }
    }
    sums
}
