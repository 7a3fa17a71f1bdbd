//! Weights of a load along a row of the grid, for spreading and interpolation.
//!
//! At the point `(x, y, z)` relative to a particle, component `c` of its force density is
//!
//! ```text
//! F_c a + (G_c . r) b,     a = m g(r),     b = q g'(r)
//! ```
//!
//! with Gaussians `g`, `g'`. In a lattice sheared by `s`, `x = X + s y`, where `X` depends on the column of the grid
//! alone. So `G_c . r = (G_cx X + G_cz z) + (s G_cx + G_cy) y`, of which the bracket is the same for all rows of a
//! plane, and the weights `a` and `b` are the same for all components: a row takes three fused multiply-adds per
//! component. Interpolation weights the velocity with the same products, which makes it the exact adjoint of
//! spreading.

use crate::envelope::Source;
use simd::{SimdVector as Lanes, exponential};
use solver::Real;

/// Gaussians of a particle, and the strain of the lattice.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sources {
    pub monopole: Source,
    pub dipole: Source,
    pub strain: f64,
}

/// Terms that are spread or interpolated, known at compile time of the kernels.
pub(crate) trait GaussianShape: Sync {
    /// Forces, or velocities.
    const FORCES: bool;
    /// Dipoles, or velocity gradients.
    const DIPOLES: bool;
}

/// The terms as const parameters.
pub(crate) struct Terms<const FORCES: bool, const DIPOLES: bool>;

impl<const FORCES: bool, const DIPOLES: bool> GaussianShape for Terms<FORCES, DIPOLES> {
    const FORCES: bool = FORCES;
    const DIPOLES: bool = DIPOLES;
}

/// Columns of the stencil: their `X`, and `exp(-X^2 / (2 width^2))` for the monopole and the dipole.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GaussianColumns<V> {
    pub x: V,
    pub gaussians: [V; 2],
}

/// A row of the stencil: its `y`, and `exp(-(1 + s^2) y^2 / (2 width^2))` for the monopole and the dipole.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StencilRow<T> {
    pub y: T,
    pub gaussians: [T; 2],
}

/// Number of vectors that [`tabulate`] writes for a row.
pub(crate) const OF_ROW: usize = 2;

/// Writes the factors of the weights on a row that do not depend on `z`: the two Gaussians.
///
/// # Safety
/// There is room for [`OF_ROW`] vectors.
#[inline(always)]
pub(crate) unsafe fn tabulate<T: Real, S: GaussianShape, V: Lanes<T>>(
    sources: &Sources,
    columns: &GaussianColumns<V>,
    row: &StencilRow<T>,
    table: *mut T,
) {
    if S::FORCES {
        unsafe { gaussian(&sources.monopole, 0, sources.strain, columns, row).store(table) };
    }
    if S::DIPOLES {
        unsafe { gaussian(&sources.dipole, 1, sources.strain, columns, row).store(table.add(V::LANES)) };
    }
}

/// `exp(-((X + s y)^2 + y^2) / (2 width^2))`: in an orthogonal box the product of Gaussians of `X` and of `y`.
#[inline(always)]
fn gaussian<T: Real, V: Lanes<T>>(
    source: &Source,
    kind: usize,
    strain: f64,
    columns: &GaussianColumns<V>,
    row: &StencilRow<T>,
) -> V {
    if strain == 0.0 {
        return columns.gaussians[kind].mul(V::splat(row.gaussians[kind]));
    }
    let y = V::splat(row.y);
    let x = y.mul_add(V::splat(T::from_f64(strain)), columns.x);
    let factor = V::splat(T::from_f64(-0.5 / (source.width * source.width)));
    exponential(x.mul_add(x, y.mul(y)).mul(factor))
}

/// Weights `a` and `b` on a tabulated row, in a plane with the given peaks, which are `m` and `q` times the Gaussians
/// of `z`. Terms that the shape does not have are not computed.
///
/// # Safety
/// The table is that of a row.
#[inline(always)]
pub(crate) unsafe fn weights<T: Real, S: GaussianShape, V: Lanes<T>>(peaks: [T; 2], table: *const T) -> [V; 2] {
    unsafe { [V::load(table).mul(V::splat(peaks[0])), V::load(table.add(V::LANES)).mul(V::splat(peaks[1]))] }
}
