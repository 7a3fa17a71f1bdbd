//! How a load becomes values along a row of the grid, and how those values are weighed on the way back.
//!
//! At the point `(x, y, z)` relative to a particle, what is spread of component `c` is
//!
//! ```text
//! F_c a + (G_c . r) b,     a = m g(r),     b = q g'(r)
//! ```
//!
//! with Gaussians `g`, `g'`. In a lattice sheared by `s`, `x = X + s y` where `X` belongs to the column of the grid
//! alone. So `G_c . r = (G_cx X + G_cz z) + (s G_cx + G_cy) y`, of which the bracket is the same for the rows of a
//! plane, and the weights `a` and `b` are the same for all components: a row takes three fused multiplications a
//! component. Interpolation weighs the velocity with the same products, which makes it the exact adjoint of spreading.

use crate::envelope::Source;
use solver::Real;
use solver::simd::{Vector as Lanes, exponential};

/// A particle's sources and the lattice's strain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sources {
    pub monopole: Source,
    pub dipole: Source,
    pub strain: f64,
}

/// Which terms are spread or asked for, known where the kernels are compiled.
pub(crate) trait Shape: Sync {
    /// Forces, or velocities.
    const FORCES: bool;
    /// Dipoles, or velocity gradients.
    const DIPOLES: bool;
}

/// The terms by name.
pub(crate) struct Terms<const FORCES: bool, const DIPOLES: bool>;

impl<const FORCES: bool, const DIPOLES: bool> Shape for Terms<FORCES, DIPOLES> {
    const FORCES: bool = FORCES;
    const DIPOLES: bool = DIPOLES;
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

/// Writes what the weights on a row are made of, apart from what depends on `z`: the two Gaussians.
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
    if S::FORCES {
        unsafe { gaussian((&sources.monopole, 0), sources.strain, columns, row).store(table) };
    }
    if S::DIPOLES {
        unsafe { gaussian((&sources.dipole, 1), sources.strain, columns, row).store(table.add(V::LANES)) };
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

/// The weights `a` and `b` on a row that was tabulated, in a plane with the given peaks, `m` and `q` times the
/// Gaussians of `z`; of those that the shape does not have, nothing is computed.
///
/// # Safety
/// The table is that of a row.
#[inline(always)]
pub(crate) unsafe fn weights<T: Real, S: Shape, V: Lanes<T>>(peaks: [T; 2], table: *const T) -> [V; 2] {
    unsafe { [V::load(table).mul(V::splat(peaks[0])), V::load(table.add(V::LANES)).mul(V::splat(peaks[1]))] }
}
