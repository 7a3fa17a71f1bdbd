//! Spreading and interpolation with the Gaussian envelopes themselves.

use crate::grid::gaussian::axis::{AxisPoints, GaussianAxis};
use crate::grid::gaussian::passes::{GaussianPass, PassPoint, passes};
use crate::grid::gaussian::shape::{GaussianColumns, GaussianShape, OF_ROW, Sources, StencilRow, tabulate, weights};
use crate::grid::kernel::{Kernel, Load, NOT_IN_SLAB, Slab, SphereStencil, StencilOffsets, WeightedSums};
use crate::grid::stencil::{Stencil, Support};
use crate::grid::totals::Totals;
use domain::Vector;
use simd::SimdVector as Lanes;
use solver::{AlignedMemory, Grid, Real};
use std::marker::PhantomData;

/// Grid, passes over a stencil, and envelopes by class of radius.
pub(crate) struct GaussianLattice {
    pub points: [usize; 3],
    pub spacing: Vector,
    pub support: Support,
    pub passes: Vec<GaussianPass>,
    pub sources: Vec<Sources>,
}

impl GaussianLattice {
    /// For a grid of values of type `T`.
    pub fn new<T: Real>(grid: &Grid, support: Support, sources: Vec<Sources>) -> Self {
        let (points, spacing) = (grid.points(), grid.spacing());
        let passes = passes(&support, spacing, grid.cell().strain(), T::LANES);
        Self { points, spacing, support, passes, sources }
    }
}

/// Kernel for some of the multipole terms.
pub(crate) struct Gaussians<'a, S> {
    pub lattice: &'a GaussianLattice,
    pub shape: PhantomData<S>,
}

/// Vectors per plane of a stencil: one for each component, and one that begins with the peaks of the monopole and the
/// dipole.
const OF_PLANE: usize = 4;
const PEAKS: usize = 3;

/// Stencil of one particle along its axes, its position in the slab, and tables for the current pass.
#[derive(Default)]
pub(crate) struct GaussianScratch<T: Real> {
    axes: [GaussianAxis<T>; 3],
    starts: StencilOffsets,
    /// Rows of the current pass that are in the slab, if not all are.
    some: Vec<PassPoint>,
    /// Per row: factors of the weights of the pass.
    tables: AlignedMemory<T>,
    /// Per plane: factors that its rows share.
    levels: AlignedMemory<T>,
    totals: Totals<T>,
}

impl<T: Real> GaussianScratch<T> {
    /// Prepares the passes of a particle; returns the end of its last row in the slab, or `None` if no row is in the
    /// slab.
    #[inline(always)]
    fn prepare<S: GaussianShape, V: Lanes<T>, X>(
        &mut self,
        stencil: &Stencil,
        sources: &Sources,
        lattice: &GaussianLattice,
        slab: &Slab<X>,
    ) -> Option<usize> {
        let Support { lanes: columns, support, .. } = lattice.support;
        let last = self.starts.find(stencil, support, lattice.points, slab)?;
        self.tables.resize(support * OF_ROW * T::LANES);
        self.levels.resize(support * OF_PLANE * T::LANES);
        let (offset, spacing) = (stencil.offset, lattice.spacing);
        let [x, y, z] = &mut self.axes;
        let along = |count, axis: usize| AxisPoints { count, offset: offset[axis], spacing: spacing[axis] };
        x.fill::<S, V>(along(columns, 0), sources, 1.0);
        y.fill::<S, V>(along(support, 1), sources, sources.strain.mul_add(sources.strain, 1.0).sqrt());
        z.fill::<S, V>(along(support, 2), sources, 1.0);
        Some(last + stencil.first[0] as usize + columns)
    }

    /// Tabulates the rows and planes of a pass.
    #[inline(always)]
    fn tabulate<S: GaussianShape, V: Lanes<T>>(&mut self, pass: &GaussianPass, sources: &Sources) {
        let [x, y, z] = &self.axes;
        let [monopole, dipole] = x.gaussians();
        let part = pass.column..pass.column + V::LANES;
        // SAFETY: the parts have as many values as a vector.
        let columns = unsafe {
            let gaussians = [V::load(monopole[part.clone()].as_ptr()), V::load(dipole[part.clone()].as_ptr())];
            GaussianColumns { x: V::load(x.distances()[part].as_ptr()), gaussians }
        };
        let tables = self.tables.values_mut().chunks_exact_mut(OF_ROW * V::LANES);
        let [monopole, dipole] = y.gaussians();
        for (point, table) in tables.enumerate().take(pass.span.end).skip(pass.span.start) {
            let row = StencilRow { y: y.distances()[point], gaussians: [monopole[point], dipole[point]] };
            // SAFETY: a table is as long as it needs to be.
            unsafe { tabulate::<T, S, V>(sources, &columns, &row, table.as_mut_ptr()) };
        }
        let [monopole, dipole] = z.gaussians();
        let levels = self.levels.values_mut().chunks_exact_mut(OF_PLANE * V::LANES);
        for (point, level) in levels.enumerate().take(self.starts.planes.len()) {
            level[PEAKS * V::LANES] = T::from_f64(sources.monopole.peak) * monopole[point];
            level[PEAKS * V::LANES + 1] = T::from_f64(sources.dipole.peak) * dipole[point];
        }
    }

    /// Begins a pass: tabulates it and finds its rows in the slab.
    #[inline(always)]
    fn begin<S: GaussianShape, V: Lanes<T>>(&mut self, pass: &GaussianPass, sources: &Sources) {
        self.tabulate::<S, V>(pass, sources);
        if self.starts.whole {
            return;
        }
        self.some.clear();
        for &point in &pass.rows {
            let StencilOffsets { rows, planes, .. } = &self.starts;
            if planes[point.z as usize] != NOT_IN_SLAB && rows[point.y as usize] != NOT_IN_SLAB {
                self.some.push(point);
            }
        }
    }

    /// Rows of a pass that are in the slab.
    #[inline(always)]
    fn rows<'a>(&'a self, pass: &'a GaussianPass) -> &'a [PassPoint] {
        if self.starts.whole { &pass.rows } else { &self.some }
    }

    /// A row of the current pass.
    ///
    /// # Safety
    /// The row is one of [`GaussianScratch::rows`].
    #[inline(always)]
    unsafe fn row<V: Lanes<T>>(&self, point: PassPoint) -> StencilPosition<T> {
        let (y, z) = (point.y as usize, point.z as usize);
        unsafe {
            StencilPosition {
                start: *self.starts.planes.get_unchecked(z) + *self.starts.rows.get_unchecked(y),
                y: *self.axes[1].distances().get_unchecked(y),
                z: *self.axes[2].distances().get_unchecked(z),
                table: self.tables.values().as_ptr().add(y * OF_ROW * V::LANES),
                plane: self.levels.values().as_ptr().add(z * OF_PLANE * V::LANES),
            }
        }
    }

    /// Distances along x of the columns of a pass.
    #[inline(always)]
    fn columns<V: Lanes<T>>(&self, pass: &GaussianPass) -> V {
        let columns = &self.axes[0].distances()[pass.column..pass.column + V::LANES];
        // SAFETY: the slice has as many values as a vector.
        unsafe { V::load(columns.as_ptr()) }
    }
}

/// A row of the stencil: offset of its first column in a component, distances from the particle along y and z, its
/// table, and the factors of its plane.
struct StencilPosition<T> {
    start: usize,
    y: T,
    z: T,
    table: *const T,
    plane: *const T,
}

impl<T: Real> StencilPosition<T> {
    /// # Safety
    /// The current pass began with vectors of type `V`.
    #[inline(always)]
    unsafe fn weights<S: GaussianShape, V: Lanes<T>>(&self) -> [V; 2] {
        unsafe {
            let peaks = self.plane.add(PEAKS * V::LANES);
            weights::<T, S, V>([*peaks, *peaks.add(1)], self.table)
        }
    }
}

impl<T: Real, S: GaussianShape> Kernel<T> for Gaussians<'_, S> {
    type Scratch = GaussianScratch<T>;

    fn planes(&self) -> usize {
        self.lattice.support.support
    }

    #[inline(always)]
    fn deposit<V: Lanes<T>>(
        &self,
        scratch: &mut GaussianScratch<T>,
        sphere: SphereStencil,
        load: &Load<T>,
        slab: &mut Slab<&mut [T]>,
    ) {
        let SphereStencil { stencil, class } = sphere;
        let sources = &self.lattice.sources[class as usize];
        let Some(end) = scratch.prepare::<S, V, _>(stencil, sources, self.lattice, slab) else {
            return;
        };
        let [x, y, z] = slab.components.each_mut().map(|component| {
            // Checked once per particle, not at every row.
            assert!(end <= component.len(), "a stencil ends within its planes");
            component.as_mut_ptr()
        });
        let sphere = LoadedSphere { sources, load };
        for pass in &self.lattice.passes {
            let column = stencil.first[0] as usize + pass.column;
            // SAFETY: the end was checked, and no pass goes beyond the stencil's columns.
            unsafe {
                let components = [x.add(column), y.add(column), z.add(column)];
                if pass.half {
                    deposit_pass::<T, S, V::Half>(scratch, pass, &sphere, components);
                } else {
                    deposit_pass::<T, S, V>(scratch, pass, &sphere, components);
                }
            }
        }
    }

    #[inline(always)]
    fn collect<V: Lanes<T>>(
        &self,
        scratch: &mut GaussianScratch<T>,
        sphere: SphereStencil,
        slab: &Slab<&[T]>,
    ) -> WeightedSums<T> {
        let SphereStencil { stencil, class } = sphere;
        let sources = &self.lattice.sources[class as usize];
        scratch.totals.clear();
        if let Some(end) = scratch.prepare::<S, V, _>(stencil, sources, self.lattice, slab) {
            let [x, y, z] = slab.components.map(|component| {
                assert!(end <= component.len(), "a stencil ends within its planes");
                component.as_ptr()
            });
            for pass in &self.lattice.passes {
                let column = stencil.first[0] as usize + pass.column;
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
        WeightedSums { velocity: [vx, vy, vz], gradient: [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] }
    }
}

/// Gaussians of a particle, and the load that they spread.
struct LoadedSphere<'a, T> {
    sources: &'a Sources,
    load: &'a Load<T>,
}

/// Adds the load to the rows of a pass, whose first columns are at `components`.
///
/// # Safety
/// All its rows can be read and written.
#[inline(always)]
unsafe fn deposit_pass<T: Real, S: GaussianShape, V: Lanes<T>>(
    scratch: &mut GaussianScratch<T>,
    pass: &GaussianPass,
    LoadedSphere { sources, load }: &LoadedSphere<T>,
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
                // SAFETY: a plane has a vector for each component.
                unsafe { along.store(plane.as_mut_ptr().add(c * V::LANES)) };
            }
        }
    }
    for &point in scratch.rows(pass) {
        unsafe {
            let row = scratch.row::<V>(point);
            let [a, b] = row.weights::<S, V>();
            let y = V::splat(row.y);
            for c in 0..3 {
                let values = components[c].add(row.start);
                let mut sum = V::load(values);
                if S::FORCES {
                    sum = force[c].mul_add(a, sum);
                }
                if S::DIPOLES {
                    let along = V::load(row.plane.add(c * V::LANES));
                    sum = across[c].mul_add(y, along).mul_add(b, sum);
                }
                sum.store(values);
            }
        }
    }
}

/// Sums of the velocity over the rows of a pass, with the weights of the stencil. The rows' first columns are at
/// `components`.
///
/// # Safety
/// All its rows can be read.
#[inline(always)]
unsafe fn collect_pass<T: Real, S: GaussianShape, V: Lanes<T>>(
    scratch: &mut GaussianScratch<T>,
    pass: &GaussianPass,
    sources: &Sources,
    components: [*const T; 3],
) {
    scratch.begin::<S, V>(pass, sources);
    let zero = V::splat(T::default());
    // Sums with the weights `a`, and with `b` times 1, y and z.
    let (mut velocity, mut level, mut across, mut up) = ([zero; 3], [zero; 3], [zero; 3], [zero; 3]);
    for &point in scratch.rows(pass) {
        unsafe {
            let row = scratch.row::<V>(point);
            let [a, b] = row.weights::<S, V>();
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
