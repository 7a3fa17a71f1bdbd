//! Grid and window in lattice coordinates.

use crate::envelope::{Common, Envelope};
use crate::grid::window::KaiserBessel;
use crate::grid::window::pieces::Pieces;
use solver::{Grid, Real};

/// Second derivatives of the Laplacian in lattice coordinates; the last two only in a tilted lattice.
pub(crate) const SECOND: [[usize; 3]; 6] = [[2, 0, 0], [1, 1, 0], [0, 2, 0], [0, 0, 2], [1, 0, 1], [0, 1, 1]];

/// Number of these for a lattice that is not tilted.
pub(crate) const UPRIGHT: usize = 4;

/// Window on a grid. Its derivatives are along the lattice coordinates `X`, `Y` and `Z`, in units of the spacings.
/// The derivatives along the box's axes are
///
/// ```text
/// d/dx = d/dX,      d/dy = d/dY - s d/dX,      d/dz = d/dZ - r d/dY - f d/dX,      f = t - s r
/// ```
#[derive(Debug, Clone)]
pub(crate) struct WindowLattice<T> {
    pub points: [usize; 3],
    /// Points along x by which each row begins before the previous one, see [`Grid::row_shift`].
    pub row_shift: usize,
    pub window: KaiserBessel,
    pub pieces: Pieces<T>,
    /// Inverse spacings.
    pub inverse: [f64; 3],
    pub slants: Slants<f64>,
    /// Whether the third lattice vector is tilted.
    is_tilted: bool,
    /// Coefficients of `1 - (d - D)/2 lap` apart from the 1, by [`SECOND`], of the monopole and the dipole by class
    /// of radius.
    smoothing: Vec<[[T; SECOND.len()]; 2]>,
    /// Coefficients of the Laplacian.
    laplacian: [T; SECOND.len()],
}

/// The operator `1 - (d - D)/2 lap` of a source: its coefficients apart from the 1, by [`SECOND`], and whether the
/// third lattice vector is tilted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Smoothing<T> {
    pub factors: [T; SECOND.len()],
    pub is_tilted: bool,
}

/// Strain and tilts of a lattice: `s`, `r` and `f`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slants<T> {
    pub s: T,
    pub r: T,
    pub f: T,
}

impl<T: Real> WindowLattice<T> {
    /// For envelopes that share a common Gaussian.
    pub fn new(grid: &Grid, window: KaiserBessel, common: Common, envelopes: &[Envelope]) -> Self {
        Self::of_pieces(grid, window, Pieces::new(window), common, envelopes)
    }

    /// The same window for other envelopes, or on a grid that has been sheared.
    pub fn with_envelopes(&self, grid: &Grid, common: Common, envelopes: &[Envelope]) -> Self {
        Self::of_pieces(grid, self.window, self.pieces.clone(), common, envelopes)
    }

    fn of_pieces(grid: &Grid, window: KaiserBessel, pieces: Pieces<T>, common: Common, envelopes: &[Envelope]) -> Self {
        let (inverse, s, [t, r]) = (grid.spacing().recip().to_array(), grid.strain(), grid.cell().tilts());
        let ([x, y, z], f) = (inverse, t - s * r);
        let laplacian = [
            (1.0 + s * s + f * f) * x * x,
            (-2.0 * s + 2.0 * r * f) * x * y,
            (1.0 + r * r) * y * y,
            z * z,
            -2.0 * f * x * z,
            -2.0 * r * y * z,
        ];
        let factors = |sigma: f64| laplacian.map(|factor| T::from_f64(-0.5 * common.rest(sigma) * factor));
        let smoothing = envelopes.iter().map(|e| [factors(e.monopole), factors(e.dipole)]).collect();
        let laplacian = laplacian.map(T::from_f64);
        let (slants, is_tilted) = (Slants { s, r, f }, !grid.cell().is_orthogonal());
        let points = grid.points();
        let row_shift = grid.row_shift().rem_euclid(points[0] as i64) as usize;
        Self { points, row_shift, window, pieces, inverse, slants, is_tilted, smoothing, laplacian }
    }

    /// Highest order of derivatives that forces, dipoles or both need.
    pub fn order(&self, forces: bool, dipoles: bool) -> usize {
        let of_forces = if self.is_common(0) { 0 } else { 2 };
        let of_dipoles = if self.is_common(1) { 1 } else { 3 };
        usize::max(if forces { of_forces } else { 0 }, if dipoles { of_dipoles } else { 0 })
    }

    /// Whether all monopoles (0), or all dipoles (1), have the common Gaussian without a bracket of their own.
    fn is_common(&self, multipole: usize) -> bool {
        self.smoothing.iter().all(|class| class[multipole][2].to_f64().abs() < 1e-14)
    }

    /// `1/h` along each axis, and the strain and tilts of the lattice.
    #[inline(always)]
    pub fn slopes(&self) -> ([T; 3], Slants<T>) {
        let ([x, y, z], Slants { s, r, f }) = (self.inverse, self.slants);
        let slants = Slants { s: T::from_f64(s), r: T::from_f64(r), f: T::from_f64(f) };
        ([T::from_f64(x), T::from_f64(y), T::from_f64(z)], slants)
    }

    /// The Laplacian itself.
    #[inline(always)]
    pub fn laplacian(&self) -> Smoothing<T> {
        Smoothing { factors: self.laplacian, is_tilted: self.is_tilted }
    }

    /// Smoothing of a class's monopole (0) or dipole (1).
    #[inline(always)]
    pub fn smoothing(&self, class: u32, multipole: usize) -> Smoothing<T> {
        Smoothing { factors: self.smoothing[class as usize][multipole], is_tilted: self.is_tilted }
    }
}
