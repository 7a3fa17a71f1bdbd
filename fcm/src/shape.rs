//! How a load becomes values along a row of the grid, and how those values are weighed on the way back.
//!
//! At the point `(x, y, z)` relative to a particle, what is spread of component `c` is
//!
//! ```text
//! F_c a + (G_c . r) b,     a = (m + m' r^2) g(r),     b = (q + q' r^2) g'(r)
//! ```
//!
//! with Gaussians `g`, `g'`. In a lattice sheared by `s`, `x = X + s y` where `X` belongs to the column of the grid
//! alone. So `G_c . r = (G_cx X + G_cz z) + (s G_cx + G_cy) y`, of which the bracket is the same for the rows of a plane,
//! and the weights `a` and `b` are the same for all components: a row takes three fused multiplications a component.
//! Interpolation weighs the velocity with the same products, which makes it the exact adjoint of spreading.

use crate::envelope::Source;
use crate::exponential::exponential;
use domain::{Tensor, Vector};
use solver::Real;
use solver::simd::Vector as Lanes;

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

/// A particle's sources and the lattice's strain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sources {
    pub monopole: Source,
    pub dipole: Source,
    pub strain: f64,
}

/// Which terms are spread or asked for, known where the kernels are compiled.
pub(crate) trait Shape {
    /// Forces, or velocities.
    const FORCES: bool;
    /// Dipoles, or velocity gradients.
    const DIPOLES: bool;
    /// Whether both are on one wide Gaussian times a polynomial in `r^2`, or on Gaussians of their own without one.
    const WIDE: bool;
}

/// On one common Gaussian.
pub(crate) struct Wide<const FORCES: bool, const DIPOLES: bool>;

impl<const FORCES: bool, const DIPOLES: bool> Shape for Wide<FORCES, DIPOLES> {
    const FORCES: bool = FORCES;
    const DIPOLES: bool = DIPOLES;
    const WIDE: bool = true;
}

/// On Gaussians of their own.
pub(crate) struct Own<const FORCES: bool, const DIPOLES: bool>;

impl<const FORCES: bool, const DIPOLES: bool> Shape for Own<FORCES, DIPOLES> {
    const FORCES: bool = FORCES;
    const DIPOLES: bool = DIPOLES;
    const WIDE: bool = false;
}

/// Some columns of the stencil: their `X`, and `exp(-X^2 / (2 width^2))` for the monopole and the dipole.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns<V> {
    pub x: V,
    pub gaussians: [V; 2],
}

/// A row of the stencil: its `y`, and `exp(-(1 + s^2) y^2 / (2 width^2))` for the monopole and the dipole.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row<T> {
    pub y: T,
    pub gaussians: [T; 2],
}

/// Vectors that [`tabulate`] writes for a row.
pub(crate) const OF_ROW: usize = 2;

/// Writes what the weights on a row are made of, apart from what depends on `z`: the part of `r^2` that depends on `y`,
/// `2 s X y + (1 + s^2) y^2`, and the common Gaussian; or the two Gaussians.
///
/// # Safety
/// There is room for [`OF_ROW`] vectors.
#[inline(always)]
pub(crate) unsafe fn tabulate<T: Real, S: Shape, V: Lanes<T>>(
    sources: &Sources,
    columns: &Columns<V>,
    row: &Row<T>,
    table: *mut T,
) {
    let (first, second) = unsafe { (table, table.add(V::LANES)) };
    let [monopole, dipole] = [(&sources.monopole, 0), (&sources.dipole, 1)];
    if S::WIDE {
        let strain = T::from_f64(sources.strain);
        let level = V::splat(strain.mul_add(strain, T::from_f64(1.0)) * row.y * row.y);
        let tilt = V::splat(T::from_f64(2.0) * strain * row.y);
        unsafe { columns.x.mul_add(tilt, level).store(first) };
        unsafe { gaussian(monopole, sources.strain, columns, row).store(second) };
    } else {
        if S::FORCES {
            unsafe { gaussian(monopole, sources.strain, columns, row).store(first) };
        }
        if S::DIPOLES {
            unsafe { gaussian(dipole, sources.strain, columns, row).store(second) };
        }
    }
}

/// `exp(-((X + s y)^2 + y^2) / (2 width^2))`: in a straight box the product of Gaussians of `X` and of `y`.
#[inline(always)]
fn gaussian<T: Real, V: Lanes<T>>(
    (source, kind): (&Source, usize),
    strain: f64,
    columns: &Columns<V>,
    row: &Row<T>,
) -> V {
    if strain == 0.0 {
        return columns.gaussians[kind].mul(V::splat(row.gaussians[kind]));
    }
    let y = V::splat(row.y);
    let x = y.mul_add(V::splat(T::from_f64(strain)), columns.x);
    let factor = V::splat(T::from_f64(-0.5 / (source.width * source.width)));
    exponential(x.mul_add(x, y.mul(y)).mul(factor))
}

/// Vectors of a [`Level`].
pub(crate) const OF_LEVEL: usize = 3;

/// What the rows of a plane of the stencil share, for some columns, in memory: for each weight the vector
/// `(m + m' (X^2 + z^2)) w` and the number `m' w` with the Gaussian `w` of `z`.
#[derive(Clone, Copy)]
pub(crate) struct Level<T>(*const T);

impl<T: Real> Level<T> {
    /// Writes it. `decay` are the Gaussians of `z` for the monopole and for the dipole.
    ///
    /// # Safety
    /// There is room for [`OF_LEVEL`] vectors.
    #[inline(always)]
    pub unsafe fn write<V: Lanes<T>>(sources: &Sources, x: V, z: T, decay: [T; 2], to: *mut T) {
        let square = x.mul_add(x, V::splat(z * z));
        for (kind, source) in [sources.monopole, sources.dipole].iter().enumerate() {
            let quadratic = T::from_f64(source.quadratic) * decay[kind];
            let level = V::splat(T::from_f64(source.constant) * decay[kind]);
            unsafe { square.mul_add(V::splat(quadratic), level).store(to.add(kind * V::LANES)) };
            unsafe { *to.add(2 * V::LANES + kind) = quadratic };
        }
    }

    /// The one that was written there.
    #[inline(always)]
    pub fn at(from: *const T) -> Self {
        Self(from)
    }

    /// The weights `a` and `b` on a row that was tabulated; of those that the shape does not have, nothing is computed.
    ///
    /// # Safety
    /// The level was written, and the table is that of a row.
    #[inline(always)]
    pub unsafe fn weights<S: Shape, V: Lanes<T>>(self, table: *const T) -> [V; 2] {
        unsafe {
            let [first, second] = [V::load(table), V::load(table.add(V::LANES))];
            let [m, q] = [V::load(self.0), V::load(self.0.add(V::LANES))];
            if S::WIDE {
                let [dm, dq] = [V::splat(*self.0.add(2 * V::LANES)), V::splat(*self.0.add(2 * V::LANES + 1))];
                [first.mul_add(dm, m).mul(second), first.mul_add(dq, q).mul(second)]
            } else {
                [first.mul(m), second.mul(q)]
            }
        }
    }
}
