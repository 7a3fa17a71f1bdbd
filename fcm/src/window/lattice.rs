//! The grid as a window sees it.

use crate::envelope::{Common, Envelope};
use crate::window::Window;
use crate::window::pieces::Pieces;
use solver::{Grid, Real};

/// The derivatives of second order that the Laplacian has in lattice coordinates.
pub(crate) const SECOND: [[usize; 3]; 4] = [[2, 0, 0], [1, 1, 0], [0, 2, 0], [0, 0, 2]];

/// A window on a grid: derivatives along its lattice coordinates, `x = X + s y` in a box sheared by `s`, in units of
/// the spacings.
#[derive(Debug, Clone)]
pub(crate) struct Lattice<T> {
    pub points: [usize; 3],
    pub window: Window,
    pub pieces: Pieces<T>,
    /// Inverse spacings.
    pub inverse: [f64; 3],
    pub strain: f64,
    /// Those of `1 - (d - D)/2 lap` beyond the 1, by [`SECOND`], of the monopole and the dipole by class of radius.
    smoothing: Vec<[[T; 4]; 2]>,
}

impl<T: Real> Lattice<T> {
    /// For envelopes that share a common Gaussian.
    pub fn new(grid: &Grid, window: Window, common: Common, envelopes: &[Envelope]) -> Self {
        Self::of_pieces(grid, (window, Pieces::new(window)), common, envelopes)
    }

    /// The same window on a grid that has been sheared.
    pub fn sheared(&self, grid: &Grid, common: Common, envelopes: &[Envelope]) -> Self {
        Self::of_pieces(grid, (self.window, self.pieces.clone()), common, envelopes)
    }

    fn of_pieces(grid: &Grid, (window, pieces): (Window, Pieces<T>), common: Common, envelopes: &[Envelope]) -> Self {
        let (inverse, strain) = (grid.spacing().recip().to_array(), grid.cell().strain());
        let [x, y, z] = inverse;
        // d/dy at rest is d/dy - s d/dX along the lattice.
        let laplacian = [(1.0 + strain * strain) * x * x, -2.0 * strain * x * y, y * y, z * z];
        let factors = |sigma: f64| laplacian.map(|factor| T::from_f64(-0.5 * common.rest(sigma) * factor));
        let smoothing = envelopes.iter().map(|e| [factors(e.monopole), factors(e.dipole)]).collect();
        Self { points: grid.points(), window, pieces, inverse, strain, smoothing }
    }

    /// The highest order of derivatives that forces or dipoles or both need.
    pub fn order(&self, forces: bool, dipoles: bool) -> usize {
        let of_forces = if self.is_common(0) { 0 } else { 2 };
        let of_dipoles = if self.is_common(1) { 1 } else { 3 };
        usize::max(if forces { of_forces } else { 0 }, if dipoles { of_dipoles } else { 0 })
    }

    /// Whether all monopoles, 0, or all dipoles, 1, are the common Gaussian without more.
    fn is_common(&self, multipole: usize) -> bool {
        self.smoothing.iter().all(|class| class[multipole][2].to_f64().abs() < 1e-14)
    }

    /// `1/h` along each axis, and the strain.
    #[inline(always)]
    pub fn slopes(&self) -> ([T; 3], T) {
        let [x, y, z] = self.inverse;
        ([T::from_f64(x), T::from_f64(y), T::from_f64(z)], T::from_f64(self.strain))
    }

    /// `1 - (d - D)/2 lap` beyond the 1, by [`SECOND`], for a class's monopole, 0, or dipole, 1.
    #[inline(always)]
    pub fn smoothing(&self, class: u32, multipole: usize) -> [T; 4] {
        self.smoothing[class as usize][multipole]
    }
}
