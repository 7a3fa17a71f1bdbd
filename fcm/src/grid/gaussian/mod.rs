//! Kernel of the direct method: every envelope itself on the grid.

mod axis;
mod kernel;
mod passes;
mod shape;

pub(crate) use kernel::{GaussianLattice, Gaussians};
pub(crate) use passes::{STEP, length};
pub(crate) use shape::{Sources, Terms};
