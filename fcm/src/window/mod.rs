//! The split method's kernel: a narrow window on the grid, and everything else in the spectrum.
//!
//! What the split method wants on the grid is smooth, a wide Gaussian. A window of a few points with a compact
//! transform stands in for it: particles are spread with the window, velocities are gathered with it, and in between
//! the spectrum is divided by the window's transform twice and multiplied by the Gaussian (as non-uniform Fourier
//! transforms do). The derivatives that dipoles and the envelopes' own widths ask for are those of the window. A
//! stencil takes `6^3` points for an error of 1e-3, where the Gaussian itself takes a ball of 11 across.

mod kaiser_bessel;
mod kernel;
mod lattice;
mod pieces;

pub(crate) use kaiser_bessel::Window;
pub(crate) use kernel::Windowed;
pub(crate) use lattice::Lattice;
