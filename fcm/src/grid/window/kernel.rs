//! Spreading and interpolation with windows.
//!
//! Component `c` of a particle's spread load at the point `(X, y, z)` of the lattice relative to it is a sum
//!
//! ```text
//! sum_nml  K_c,nml  p_n(X) p_m(y) p_l(z),      n + m + l <= ORDER
//! ```
//!
//! of products of the window's derivatives `p_n`, with a few coefficients `K` that depend on the load and the class.
//! On a row that is a sum over `n` of the vectors `p_n(X)`. Their coefficients are computed for all rows of a plane
//! at once, from coefficients that are computed for all planes at once. Interpolation runs through the same steps in
//! reverse.

use crate::grid::kernel::{Kernel, Load, NOT_IN_SLAB, Slab, SphereStencil, StencilOffsets, WeightedSums};
use crate::grid::stencil::Stencil;
use crate::grid::totals::Totals;
use crate::grid::window::WindowLattice;
use crate::grid::window::coefficients::{WindowCoefficients, add, add_laplacian};
use crate::grid::window::kaiser_bessel::DERIVATIVES;
use crate::grid::window::lattice::{SECOND, Slants, Smoothing, UPRIGHT};
use crate::grid::window::potential;
use simd::SimdVector as Lanes;
use solver::{AlignedMemory, Real};

/// Kernel of `C` components with derivatives up to an order: 0 for forces and 1 for dipoles on the common Gaussian, 2
/// and 3 for forces and dipoles of envelopes of other widths. Of one component, a potential, particles have the first
/// derivatives with order 1, and the second ones as well with order 2.
pub(crate) struct Windowed<'a, T, const ORDER: usize, const C: usize = 3>(pub &'a WindowLattice<T>);

/// Derivatives of the window along the axes, offsets of the stencil in the slab, and coefficients.
#[derive(Default)]
pub(crate) struct WindowScratch<T: Real> {
    axes: [AlignedMemory<T>; 3],
    starts: StencilOffsets,
    /// Coefficients for all planes, by pair of derivatives along x and y and by component.
    of_planes: AlignedMemory<T>,
    /// Coefficients for all rows of a plane, by derivative along x and by component.
    of_rows: AlignedMemory<T>,
    totals: Totals<T>,
}

/// Number of pairs of orders of derivatives whose sum is at most three.
pub(super) const PAIRS: usize = 10;

/// Index of a pair.
pub(super) const fn pair(first: usize, second: usize) -> usize {
    [0, 4, 7, 9][first] + second
}

impl<T: Real, const ORDER: usize, const C: usize> Windowed<'_, T, ORDER, C> {
    /// Number of orders of derivatives, 0 included.
    const ORDERS: usize = ORDER + 1;

    /// Prepares a particle's stencil; returns the end of its last row in the slab, or `None` if no row is in the
    /// slab.
    #[inline(always)]
    fn prepare<V: Lanes<T>, const WIDTH: usize, X>(
        &self,
        scratch: &mut WindowScratch<T>,
        stencil: &Stencil,
        slab: &Slab<X, C>,
    ) -> Option<usize> {
        let WindowLattice { points, row_shift, window, pieces, inverse, .. } = self.0;
        let lanes = WIDTH * V::LANES;
        let last = scratch.starts.find(stencil, window.points(), *points, slab)?
            + scratch.starts.add_columns(stencil, *row_shift, points[0]);
        scratch.of_planes.resize(PAIRS * 3 * lanes);
        scratch.of_rows.resize(DERIVATIVES * 3 * lanes);
        let (mut offsets, [x, y, z]) = ([0.0; 3], &mut scratch.axes);
        for d in 0..3 {
            offsets[d] = stencil.offset[d] * inverse[d];
        }
        x.resize(DERIVATIVES * lanes);
        y.resize(DERIVATIVES * lanes);
        z.resize(DERIVATIVES * lanes);
        let to = [x.values_mut().as_mut_ptr(), y.values_mut().as_mut_ptr(), z.values_mut().as_mut_ptr()];
        // SAFETY: there is room for all derivatives.
        unsafe { pieces.write::<V, WIDTH>(offsets, Self::ORDERS, to) };
        Some(last + lanes)
    }

    /// Coefficients of a load of a particle of a class.
    #[inline(always)]
    fn coefficients(&self, class: u32, load: &Load<T, C>) -> WindowCoefficients<T, C> {
        let mut all = [[[[T::default(); C]; DERIVATIVES]; DERIVATIVES]; DERIVATIVES];
        add::<T, C, ORDER>(&mut all, [0, 0, 0], load.force, self.0.smoothing(class, 0));
        if ORDER > 0 {
            let smoothing = self.0.smoothing(class, 1);
            let ([x, y, z], Slants { s, r, f }) = self.0.slopes();
            let mut along = [[T::default(); C]; 3];
            for c in 0..C {
                let [gx, gy, gz] = load.dipole[c];
                (along[0][c], along[1][c], along[2][c]) = ((gx - s * gy - f * gz) * x, (gy - r * gz) * y, gz * z);
            }
            add::<T, C, ORDER>(&mut all, [1, 0, 0], along[0], smoothing);
            add::<T, C, ORDER>(&mut all, [0, 1, 0], along[1], smoothing);
            add::<T, C, ORDER>(&mut all, [0, 0, 1], along[2], smoothing);
        }
        if ORDER > 1 && load.quadrupole != [T::default(); C] {
            add_laplacian(&mut all, [0, 0, 0], load.quadrupole, self.0.laplacian());
        }
        all
    }

    /// Computes the coefficients of the planes.
    #[inline(always)]
    fn write_planes<V: Lanes<T>, const WIDTH: usize>(
        scratch: &mut WindowScratch<T>,
        coefficients: &WindowCoefficients<T, C>,
    ) {
        let lanes = WIDTH * V::LANES;
        let (z, to) = (scratch.axes[2].values().as_ptr(), scratch.of_planes.values_mut().as_mut_ptr());
        for part in 0..WIDTH {
            let part = part * V::LANES;
            for n in 0..Self::ORDERS {
                for m in 0..Self::ORDERS - n {
                    for c in 0..C {
                        // SAFETY: `prepare` made room.
                        unsafe {
                            let mut sum = V::load(z.add(part)).mul(V::splat(coefficients[n][m][0][c]));
                            for l in 1..Self::ORDERS - n - m {
                                let factor = V::splat(coefficients[n][m][l][c]);
                                sum = V::load(z.add(l * lanes + part)).mul_add(factor, sum);
                            }
                            sum.store(to.add((pair(n, m) * 3 + c) * lanes + part));
                        }
                    }
                }
            }
        }
    }

    /// Computes the coefficients of the rows of a plane.
    #[inline(always)]
    fn write_rows<V: Lanes<T>, const WIDTH: usize>(scratch: &mut WindowScratch<T>, plane: usize) {
        let lanes = WIDTH * V::LANES;
        let (y, from) = (scratch.axes[1].values().as_ptr(), scratch.of_planes.values().as_ptr());
        let to = scratch.of_rows.values_mut().as_mut_ptr();
        for part in 0..WIDTH {
            let part = part * V::LANES;
            for n in 0..Self::ORDERS {
                for c in 0..C {
                    // SAFETY: `prepare` made room.
                    unsafe {
                        let factor = |m: usize| V::splat(*from.add((pair(n, m) * 3 + c) * lanes + plane));
                        let mut sum = V::load(y.add(part)).mul(factor(0));
                        for m in 1..Self::ORDERS - n {
                            sum = V::load(y.add(m * lanes + part)).mul_add(factor(m), sum);
                        }
                        sum.store(to.add((n * 3 + c) * lanes + part));
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn deposit_with<V: Lanes<T>, const WIDTH: usize>(
        &self,
        scratch: &mut WindowScratch<T>,
        sphere: SphereStencil,
        load: &Load<T, C>,
        slab: &mut Slab<&mut [T], C>,
    ) {
        let SphereStencil { stencil, class } = sphere;
        let Some(end) = self.prepare::<V, WIDTH, _>(scratch, stencil, slab) else {
            return;
        };
        let components = slab.components.each_mut().map(|component| {
            // Checked once per particle, not at every row.
            assert!(end <= component.len(), "a stencil ends within its planes");
            component.as_mut_ptr()
        });
        Self::write_planes::<V, WIDTH>(scratch, &self.coefficients(class, load));
        let columns = Self::columns::<V, WIDTH>(&scratch.axes[0]);
        let lanes = WIDTH * V::LANES;
        for plane in 0..scratch.starts.planes.len() {
            let start = scratch.starts.planes[plane];
            if start == NOT_IN_SLAB {
                continue;
            }
            Self::write_rows::<V, WIDTH>(scratch, plane);
            let factors = scratch.of_rows.values().as_ptr();
            for row in 0..scratch.starts.rows.len() {
                let stencil = scratch.starts.rows[row];
                if stencil == NOT_IN_SLAB {
                    continue;
                }
                for c in 0..C {
                    for part in 0..WIDTH {
                        // SAFETY: the end was checked, and there is a factor for each row.
                        unsafe {
                            let values = components[c].add(start + stencil + part * V::LANES);
                            let mut sum = V::load(values);
                            for n in 0..Self::ORDERS {
                                let factor = V::splat(*factors.add((n * 3 + c) * lanes + row));
                                sum = columns[n][part].mul_add(factor, sum);
                            }
                            sum.store(values);
                        }
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn collect_with<V: Lanes<T>, const WIDTH: usize>(
        &self,
        scratch: &mut WindowScratch<T>,
        SphereStencil { stencil, class }: SphereStencil,
        slab: &Slab<&[T], C>,
    ) -> WeightedSums<T> {
        let Some(end) = self.prepare::<V, WIDTH, _>(scratch, stencil, slab) else {
            return WeightedSums { velocity: [T::default(); 3], gradient: [[T::default(); 3]; 3] };
        };
        let components = slab.components.map(|component| {
            assert!(end <= component.len(), "a stencil ends within its planes");
            component.as_ptr()
        });
        let lanes = WIDTH * V::LANES;
        let (y, z) = (scratch.axes[1].values().as_ptr(), scratch.axes[2].values().as_ptr());
        let zero = V::splat(T::default());
        // Sums over rows and planes, by the orders along y and z and by component.
        let mut sums = [[[zero; WIDTH]; C]; PAIRS];
        for plane in 0..scratch.starts.planes.len() {
            let start = scratch.starts.planes[plane];
            if start == NOT_IN_SLAB {
                continue;
            }
            let mut of_plane = [[[zero; WIDTH]; C]; DERIVATIVES];
            for row in 0..scratch.starts.rows.len() {
                let stencil = scratch.starts.rows[row];
                if stencil == NOT_IN_SLAB {
                    continue;
                }
                for c in 0..C {
                    for part in 0..WIDTH {
                        // SAFETY: the end was checked, and an axis has a value for each row.
                        unsafe {
                            let values = V::load(components[c].add(start + stencil + part * V::LANES));
                            for m in 0..Self::ORDERS {
                                let factor = V::splat(*y.add(m * lanes + row));
                                of_plane[m][c][part] = values.mul_add(factor, of_plane[m][c][part]);
                            }
                        }
                    }
                }
            }
            for m in 0..Self::ORDERS {
                for l in 0..Self::ORDERS - m {
                    // SAFETY: an axis has a value for each plane.
                    let factor = V::splat(unsafe { *z.add(l * lanes + plane) });
                    for c in 0..C {
                        for part in 0..WIDTH {
                            let sum = &mut sums[pair(m, l)][c][part];
                            *sum = of_plane[m][c][part].mul_add(factor, *sum);
                        }
                    }
                }
            }
        }
        let columns = Self::columns::<V, WIDTH>(&scratch.axes[0]);
        self.weighed(scratch.totals.of(&self.totals(class, &columns, &sums)))
    }

    /// Sums over the columns, smoothed by a class's widths: of the velocity and its derivatives along the lattice.
    #[inline(always)]
    fn totals<V: Lanes<T>, const WIDTH: usize>(
        &self,
        class: u32,
        columns: &[[V; WIDTH]; DERIVATIVES],
        sums: &[[[V; WIDTH]; C]; PAIRS],
    ) -> [V; 12] {
        if C == 1 {
            return potential::totals::<T, V, ORDER, C, WIDTH>(columns, sums);
        }
        let smoothing = [0, 1].map(|multipole| self.0.smoothing(class, multipole));
        let mut totals = [V::splat(T::default()); 12];
        for c in 0..C {
            totals[c] = smoothed::<T, V, ORDER, C, WIDTH>(columns, sums, [0, 0, 0], c, smoothing[0]);
            if ORDER > 0 {
                totals[3 + c] = smoothed::<T, V, ORDER, C, WIDTH>(columns, sums, [1, 0, 0], c, smoothing[1]);
                totals[6 + c] = smoothed::<T, V, ORDER, C, WIDTH>(columns, sums, [0, 1, 0], c, smoothing[1]);
                totals[9 + c] = smoothed::<T, V, ORDER, C, WIDTH>(columns, sums, [0, 0, 1], c, smoothing[1]);
            }
        }
        totals
    }

    /// Derivatives of the window along x.
    #[inline(always)]
    fn columns<V: Lanes<T>, const WIDTH: usize>(axis: &AlignedMemory<T>) -> [[V; WIDTH]; DERIVATIVES] {
        let mut columns = [[V::splat(T::default()); WIDTH]; DERIVATIVES];
        let values = axis.values()[..Self::ORDERS * WIDTH * V::LANES].as_ptr();
        for n in 0..Self::ORDERS {
            for part in 0..WIDTH {
                // SAFETY: the values are there.
                columns[n][part] = unsafe { V::load(values.add((n * WIDTH + part) * V::LANES)) };
            }
        }
        columns
    }

    /// Converts derivatives along the lattice to those along the axes.
    #[inline(always)]
    fn weighed(&self, totals: [T; 12]) -> WeightedSums<T> {
        if C == 1 {
            return potential::weighed(self.0.slopes(), totals);
        }
        let ([x, y, z], Slants { s, r, f }) = self.0.slopes();
        let mut weighed = WeightedSums { velocity: [T::default(); 3], gradient: [[T::default(); 3]; 3] };
        for c in 0..C {
            weighed.velocity[c] = totals[c];
            let (along, across) = (totals[3 + c] * x, totals[6 + c] * y);
            weighed.gradient[c] = [along, across - s * along, totals[9 + c] * z - r * across - f * along];
        }
        weighed
    }
}

/// The adjoint of [`add`], lane by lane.
#[inline(always)]
fn smoothed<T: Real, V: Lanes<T>, const ORDER: usize, const C: usize, const WIDTH: usize>(
    columns: &[[V; WIDTH]; DERIVATIVES],
    sums: &[[[V; WIDTH]; C]; PAIRS],
    [n, m, l]: [usize; 3],
    c: usize,
    smoothing: Smoothing<T>,
) -> V {
    let mut total = V::splat(T::default());
    for part in 0..WIDTH {
        total = columns[n][part].mul_add(sums[pair(m, l)][c][part], total);
    }
    if n + m + l + 2 <= ORDER {
        for second in 0..SECOND.len() {
            if second >= UPRIGHT && !smoothing.is_tilted {
                break;
            }
            let (factor, [dn, dm, dl]) = (smoothing.factors[second], SECOND[second]);
            for part in 0..WIDTH {
                let column = columns[n + dn][part].mul(V::splat(factor));
                total = column.mul_add(sums[pair(m + dm, l + dl)][c][part], total);
            }
        }
    }
    total
}

impl<T: Real, const ORDER: usize, const C: usize> Kernel<T, C> for Windowed<'_, T, ORDER, C> {
    type Scratch = WindowScratch<T>;

    fn planes(&self) -> usize {
        self.0.window.points()
    }

    #[inline(always)]
    fn deposit<V: Lanes<T>>(
        &self,
        scratch: &mut WindowScratch<T>,
        sphere: SphereStencil,
        load: &Load<T, C>,
        slab: &mut Slab<&mut [T], C>,
    ) {
        match self.0.pieces.lanes() {
            lanes if lanes < V::LANES => self.deposit_with::<V::Half, 1>(scratch, sphere, load, slab),
            lanes if lanes == V::LANES => self.deposit_with::<V, 1>(scratch, sphere, load, slab),
            _ => self.deposit_with::<V, 2>(scratch, sphere, load, slab),
        }
    }

    #[inline(always)]
    fn collect<V: Lanes<T>>(
        &self,
        scratch: &mut WindowScratch<T>,
        sphere: SphereStencil,
        slab: &Slab<&[T], C>,
    ) -> WeightedSums<T> {
        match self.0.pieces.lanes() {
            lanes if lanes < V::LANES => self.collect_with::<V::Half, 1>(scratch, sphere, slab),
            lanes if lanes == V::LANES => self.collect_with::<V, 1>(scratch, sphere, slab),
            _ => self.collect_with::<V, 2>(scratch, sphere, slab),
        }
    }
}
