//! Exact resistance and mobility functions of two rigid spheres in unbounded Stokes flow.
//!
//! [`TwoSphere::with_ratio`] gives the tables of one ratio of radii; [`TwoSphere::resistance`] and
//! [`TwoSphere::mobility`] evaluate them at any positive gap to a relative 1e-8 (an absolute error where a function
//! changes sign). Radii may differ by a factor of up to 20. A sphere at a plane wall, the limit of a large second
//! sphere, is [`SphereWall`].
//!
//! ```
//! use lubrication::two_sphere::{Function, TwoSphere, named};
//!
//! let functions = TwoSphere::with_ratio(2.0)?.resistance(1e-3)?;
//! assert!(functions[Function::XA][0][0] > 400.0);
//! assert_eq!(named(&functions)[0].0, "XA11");
//! # Ok::<(), lubrication::two_sphere::TwoSphereError>(())
//! ```

mod bispherical;
pub(crate) mod blocks;
mod double_double;
mod exact;
mod functions;
mod gap_table;
mod geometry;
mod mobility;
mod near;
mod normal_polynomial;
mod singular;
pub(crate) mod slip;
mod surface_velocity;
mod table;
pub(crate) mod tridiagonal;
mod wall;
mod wall_slip;

pub use functions::{
    Function, MobilityFunctions, Pairwise, ResistanceFunctions, WallFunctions, named, named_at_wall, named_mobility,
};
pub use slip::{SlipFunction, SlipValues, TwoSphereSlip, named_slip, named_slip_at_wall};
pub use table::{LARGEST_RATIO, TwoSphere, TwoSphereError};
pub use wall::SphereWall;
pub use wall_slip::SphereWallSlip;
