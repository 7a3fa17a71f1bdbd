//! Spreading to the grid and interpolation from it: stencils, windows and Gaussians.

pub(crate) mod gaussian;
pub(crate) mod interpolate;
pub(crate) mod kernel;
pub(crate) mod spread;
pub(crate) mod stencil;
pub(crate) mod totals;
pub(crate) mod window;
