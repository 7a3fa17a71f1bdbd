//! Kernel of the split method: a narrow window on the grid, everything else in Fourier space.
//!
//! The split method needs a smooth function on the grid, a wide Gaussian. A window of a few points with a compact
//! transform stands in for it: particles are spread and velocities interpolated with the window, and in between the
//! spectrum is divided by the window's transform twice and multiplied by the Gaussian (as in non-uniform Fourier
//! transforms). Derivatives for dipoles and for the envelopes' own widths are those of the window. A stencil takes
//! `6^3` points for an error of 1e-3, where the Gaussian itself takes a ball of 11 points across.

mod coefficients;
mod kaiser_bessel;
mod kernel;
mod lattice;
mod pieces;
mod potential;

pub(crate) use kaiser_bessel::KaiserBessel;
pub(crate) use kernel::Windowed;
pub(crate) use lattice::WindowLattice;
pub(crate) use pieces::Pieces;
