//! The two loops in which the program spends its time: a particle's stencil to the grid, and the grid to a particle.

use crate::axis::Axis;
use crate::passes::{Pass, Point};
use crate::shape::{Columns, Level, Load, OF_LEVEL, OF_ROW, Row, Shape, Sources, tabulate};
use crate::stencil::{Place, Support};
use crate::totals::Totals;
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

/// The grid as a stencil sees it, and the passes over a stencil.
#[derive(Debug, Clone)]
pub(crate) struct Lattice {
    pub points: [usize; 3],
    pub spacing: Vector,
    pub support: Support,
    pub passes: Vec<Pass>,
}

/// What has been weighed for one particle: the velocity and `gradient[c][j]`, the weight of `G_cj`.
pub(crate) struct Weighed<T> {
    pub velocity: [T; 3],
    pub gradient: [[T; 3]; 3],
}

/// Where a row or plane of a stencil would begin that is not in the slab.
const ELSEWHERE: usize = usize::MAX;

/// Vectors by plane of a stencil: its level, then one for each component.
const OF_PLANE: usize = OF_LEVEL + 3;

/// What one particle's stencil needs; kept from particle to particle to reuse its memory.
#[derive(Default)]
pub(crate) struct Scratch<T: Real> {
    /// The stencil along each axis.
    axes: [Axis<T>; 3],
    /// Where its planes begin in the slab, and where its rows begin in a plane.
    planes: Vec<usize>,
    rows: Vec<usize>,
    /// Whether the slab has all of them.
    whole: bool,
    /// Those rows of a pass that the slab has, where it does not have all.
    some: Vec<Point>,
    /// What the weights on the rows of a pass are made of, by row.
    tables: Memory<T>,
    /// What the rows of a plane share, by plane.
    levels: Memory<T>,
    totals: Totals<T>,
}

impl<T: Real> Scratch<T> {
    /// Prepares the particle's passes; returns where its last row ends in the slab, or nothing if it touches none.
    #[inline(always)]
    fn prepare<S: Shape, V: Lanes<T>, X>(
        &mut self,
        (place, sources): (&Place, &Sources),
        lattice: &Lattice,
        slab: &Slab<X>,
    ) -> Option<usize> {
        let Support { lanes: columns, support, .. } = lattice.support;
        let [_, lines, planes] = lattice.points;
        let [x, y, z] = place.first.map(|first| first as usize);
        let all_planes = starts(&mut self.planes, support, (z, planes), &slab.planes, slab.strides[1]);
        let all_rows = starts(&mut self.rows, support, (y, lines), &slab.lines, slab.strides[0]);
        let end = last(&self.planes)? + last(&self.rows)? + x + columns;
        self.whole = all_planes && all_rows;
        self.tables.resize(support * OF_ROW * T::LANES);
        self.levels.resize(support * OF_PLANE * T::LANES);
        let (offset, spacing) = (place.offset, lattice.spacing);
        let [x, y, z] = &mut self.axes;
        x.fill::<S, V>(columns, (offset.x, spacing.x), sources, 1.0);
        y.fill::<S, V>(support, (offset.y, spacing.y), sources, sources.strain.mul_add(sources.strain, 1.0).sqrt());
        z.fill::<S, V>(support, (offset.z, spacing.z), sources, 1.0);
        Some(end)
    }

    /// Tabulates the rows and the planes of a pass.
    #[inline(always)]
    fn tabulate<S: Shape, V: Lanes<T>>(&mut self, pass: &Pass, sources: &Sources) {
        let [x, y, z] = &self.axes;
        let [monopole, dipole] = x.gaussians::<S>();
        let part = pass.column..pass.column + V::LANES;
        // SAFETY: the parts have as many values as a vector.
        let columns = unsafe {
            let gaussians = [V::load(monopole[part.clone()].as_ptr()), V::load(dipole[part.clone()].as_ptr())];
            Columns { x: V::load(x.distances()[part].as_ptr()), gaussians }
        };
        let tables = self.tables.values_mut().chunks_exact_mut(OF_ROW * V::LANES);
        let [monopole, dipole] = y.gaussians::<S>();
        for (point, table) in tables.enumerate().take(pass.span.end).skip(pass.span.start) {
            let row = Row { y: y.distances()[point], gaussians: [monopole[point], dipole[point]] };
            // SAFETY: a table is as long as it needs to be.
            unsafe { tabulate::<T, S, V>(sources, &columns, &row, table.as_mut_ptr()) };
        }
        let [monopole, dipole] = z.gaussians::<S>();
        let levels = self.levels.values_mut().chunks_exact_mut(OF_PLANE * V::LANES);
        for (point, level) in levels.enumerate().take(self.planes.len()) {
            let (z, decay) = (z.distances()[point], [monopole[point], dipole[point]]);
            // SAFETY: a level is as long as it needs to be.
            unsafe { Level::write(sources, columns.x, z, decay, level.as_mut_ptr()) };
        }
    }

    /// Prepares a pass.
    #[inline(always)]
    fn begin<S: Shape, V: Lanes<T>>(&mut self, pass: &Pass, sources: &Sources) {
        self.tabulate::<S, V>(pass, sources);
        if self.whole {
            return;
        }
        self.some.clear();
        for &point in &pass.rows {
            if self.planes[point.z as usize] != ELSEWHERE && self.rows[point.y as usize] != ELSEWHERE {
                self.some.push(point);
            }
        }
    }

    /// The rows of a pass that the slab has.
    #[inline(always)]
    fn rows<'a>(&'a self, pass: &'a Pass) -> &'a [Point] {
        if self.whole { &pass.rows } else { &self.some }
    }

    /// A row of the pass that has begun.
    ///
    /// # Safety
    /// The row is one of [`Scratch::rows`].
    #[inline(always)]
    unsafe fn row<V: Lanes<T>>(&self, point: Point) -> At<T> {
        let (y, z) = (point.y as usize, point.z as usize);
        unsafe {
            At {
                start: *self.planes.get_unchecked(z) + *self.rows.get_unchecked(y),
                y: *self.axes[1].distances().get_unchecked(y),
                z: *self.axes[2].distances().get_unchecked(z),
                table: self.tables.values().as_ptr().add(y * OF_ROW * V::LANES),
                plane: self.levels.values().as_ptr().add(z * OF_PLANE * V::LANES),
            }
        }
    }

    /// The columns of a pass.
    #[inline(always)]
    fn columns<V: Lanes<T>>(&self, pass: &Pass) -> V {
        let columns = &self.axes[0].distances()[pass.column..pass.column + V::LANES];
        // SAFETY: the slice has as many values as a vector.
        unsafe { V::load(columns.as_ptr()) }
    }
}

/// A row of the stencil: where it begins in a component, apart from its first column, its distances from the particle, its
/// table and its plane's level.
struct At<T> {
    start: usize,
    y: T,
    z: T,
    table: *const T,
    plane: *const T,
}

/// Where the points of a stencil from `first` on, around and around a period, begin in a share of them; whether all do.
#[inline(always)]
fn starts(
    starts: &mut Vec<usize>,
    count: usize,
    (first, period): (usize, usize),
    share: &Range<usize>,
    stride: usize,
) -> bool {
    starts.resize(count, 0);
    let (mut point, mut all) = (first, true);
    for start in starts.iter_mut() {
        let inside = share.contains(&point);
        *start = if inside { (point - share.start) * stride } else { ELSEWHERE };
        all &= inside;
        point = if point + 1 == period { 0 } else { point + 1 };
    }
    all
}

/// The last of those that are here.
#[inline(always)]
fn last(starts: &[usize]) -> Option<usize> {
    let mut last = None;
    for &start in starts {
        if start != ELSEWHERE {
            last = last.max(Some(start));
        }
    }
    last
}

/// Adds a particle's load to the rows of a slab.
#[inline(always)]
pub(crate) fn deposit<T: Real, S: Shape, V: Lanes<T>>(
    scratch: &mut Scratch<T>,
    (place, sources, load): (&Place, &Sources, &Load<T>),
    lattice: &Lattice,
    slab: &mut Slab<&mut [T]>,
) {
    let Some(end) = scratch.prepare::<S, V, _>((place, sources), lattice, slab) else {
        return;
    };
    let [x, y, z] = slab.components.each_mut().map(|component| {
        // Checked once a particle, not at every row.
        assert!(end <= component.len(), "a stencil ends within its planes");
        component.as_mut_ptr()
    });
    for pass in &lattice.passes {
        let column = place.first[0] as usize + pass.column;
        // SAFETY: the end was checked, and no pass goes beyond the stencil's columns.
        unsafe {
            let components = [x.add(column), y.add(column), z.add(column)];
            if pass.half {
                deposit_pass::<T, S, V::Half>(scratch, pass, (sources, load), components);
            } else {
                deposit_pass::<T, S, V>(scratch, pass, (sources, load), components);
            }
        }
    }
}

/// Adds the load to the rows of a pass, whose first columns follow `components`.
///
/// # Safety
/// All its rows can be read and written.
#[inline(always)]
unsafe fn deposit_pass<T: Real, S: Shape, V: Lanes<T>>(
    scratch: &mut Scratch<T>,
    pass: &Pass,
    (sources, load): (&Sources, &Load<T>),
    components: [*mut T; 3],
) {
    scratch.begin::<S, V>(pass, sources);
    let x = scratch.columns::<V>(pass);
    let zero = V::splat(T::default());
    let (mut force, mut across) = ([zero; 3], [zero; 3]);
    for c in 0..3 {
        let [gx, gy, _] = load.dipole[c];
        force[c] = V::splat(load.force[c]);
        across[c] = V::splat(T::from_f64(sources.strain).mul_add(gx, gy));
    }
    if S::DIPOLES {
        for (plane, &z) in
            scratch.levels.values_mut().chunks_exact_mut(OF_PLANE * V::LANES).zip(scratch.axes[2].distances())
        {
            for c in 0..3 {
                let [gx, _, gz] = load.dipole[c];
                let along = x.mul_add(V::splat(gx), V::splat(gz * z));
                // SAFETY: a plane has three vectors after its level.
                unsafe { along.store(plane.as_mut_ptr().add((OF_LEVEL + c) * V::LANES)) };
            }
        }
    }
    for &point in scratch.rows(pass) {
        unsafe {
            let row = scratch.row::<V>(point);
            let [a, b] = Level::at(row.plane).weights::<S, V>(row.table);
            let y = V::splat(row.y);
            for c in 0..3 {
                let values = components[c].add(row.start);
                let mut sum = V::load(values);
                if S::FORCES {
                    sum = force[c].mul_add(a, sum);
                }
                if S::DIPOLES {
                    let along = V::load(row.plane.add((OF_LEVEL + c) * V::LANES));
                    sum = across[c].mul_add(y, along).mul_add(b, sum);
                }
                sum.store(values);
            }
        }
    }
}

/// Weighs the velocities on the rows of a slab with a particle's envelopes.
#[inline(always)]
pub(crate) fn collect<T: Real, S: Shape, V: Lanes<T>>(
    scratch: &mut Scratch<T>,
    (place, sources): (&Place, &Sources),
    lattice: &Lattice,
    slab: &Slab<&[T]>,
) -> Weighed<T> {
    scratch.totals.clear();
    if let Some(end) = scratch.prepare::<S, V, _>((place, sources), lattice, slab) {
        let [x, y, z] = slab.components.map(|component| {
            assert!(end <= component.len(), "a stencil ends within its planes");
            component.as_ptr()
        });
        for pass in &lattice.passes {
            let column = place.first[0] as usize + pass.column;
            // SAFETY: the end was checked, and no pass goes beyond the stencil's columns.
            unsafe {
                let components = [x.add(column), y.add(column), z.add(column)];
                if pass.half {
                    collect_pass::<T, S, V::Half>(scratch, pass, sources, components);
                } else {
                    collect_pass::<T, S, V>(scratch, pass, sources, components);
                }
            }
        }
    }
    let [vx, vy, vz, xx, xy, xz, yx, yy, yz, zx, zy, zz] = scratch.totals.take::<V>();
    Weighed { velocity: [vx, vy, vz], gradient: [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] }
}

/// Weighs the rows of a pass, whose first columns follow `components`.
///
/// # Safety
/// All its rows can be read.
#[inline(always)]
unsafe fn collect_pass<T: Real, S: Shape, V: Lanes<T>>(
    scratch: &mut Scratch<T>,
    pass: &Pass,
    sources: &Sources,
    components: [*const T; 3],
) {
    scratch.begin::<S, V>(pass, sources);
    let zero = V::splat(T::default());
    // Weighed by `a`, and by `b` times 1, y and z.
    let (mut velocity, mut level, mut across, mut up) = ([zero; 3], [zero; 3], [zero; 3], [zero; 3]);
    for &point in scratch.rows(pass) {
        unsafe {
            let row = scratch.row::<V>(point);
            let [a, b] = Level::at(row.plane).weights::<S, V>(row.table);
            let [by, bz] = [b.mul(V::splat(row.y)), b.mul(V::splat(row.z))];
            for c in 0..3 {
                let values = V::load(components[c].add(row.start));
                if S::FORCES {
                    velocity[c] = values.mul_add(a, velocity[c]);
                }
                if S::DIPOLES {
                    level[c] = values.mul_add(b, level[c]);
                    across[c] = values.mul_add(by, across[c]);
                    up[c] = values.mul_add(bz, up[c]);
                }
            }
        }
    }
    let (x, strain) = (scratch.columns::<V>(pass), V::splat(T::from_f64(sources.strain)));
    for c in 0..3 {
        level[c] = level[c].mul_add(x, across[c].mul(strain));
    }
    let ([vx, vy, vz], [xx, yx, zx], [xy, yy, zy], [xz, yz, zz]) = (velocity, level, across, up);
    scratch.totals.add(&[vx, vy, vz, xx, xy, xz, yx, yy, yz, zx, zy, zz]);
}
