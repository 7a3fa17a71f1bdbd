//! Images of spheres in walls, and the divergence of the mobility there.

pub(crate) mod bessel;
pub(crate) mod wall_drift;
pub(crate) mod wall_images;
pub(crate) mod wall_kernel;
