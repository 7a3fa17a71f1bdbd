//! The near field of particles in Stokes flow: exact two-sphere functions, lubrication, repulsion.
//!
//! The drag of two equal spheres that approach each other at a gap of a hundredth of their radius, over that of an
//! isolated one, is `X^A_11 - X^A_12`; by lubrication it grows like `1 / (2 gap)`.
//! ```
//! use lubrication::two_sphere::{Function, TwoSphere};
//!
//! let gap = 0.01;
//! let functions = TwoSphere::with_ratio(1.0)?.resistance(gap)?;
//! let [[own, other], _] = functions[Function::XA];
//! assert!(((own - other) * 2.0 * gap - 1.0).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arithmetic;
mod barrier;
mod block_factor;
mod chebyshev;
mod coefficients;
mod contact;
mod dense;
mod factor_table;
mod far_field;
#[cfg(test)]
mod free_pair;
mod gap_series;
mod gaussian;
mod lubrication_range;
mod memory;
mod pair_factor;
mod pair_force;
mod pair_kind;
mod pair_motion;
mod polarised_pair;
mod relative_mobility;
mod slip_force;
mod slip_row;
mod slip_table;
mod sphere_motion;
mod sphere_row;
mod sphere_row_tables;
mod surface_force;
mod surface_slip;
pub mod two_sphere;
mod wall_blocks;
mod wall_coefficients;
mod wall_factor;
mod wall_force;
mod wall_table;

pub use arithmetic::Arithmetic;
pub use barrier::{Barrier, BarrierError};
pub use coefficients::{Coefficients, RECORD};
pub use contact::{Contact, Elasticity};
pub use dense::eigenvalues;
pub use gap_series::GapSeries;
pub use lubrication_range::{LubricationRange, RangeError};
pub use pair_factor::PairFactor;
pub use pair_force::{PairForce, PairForceError};
pub use pair_kind::PairKind;
pub use pair_motion::{PairLoads, PairMotion};
pub use polarised_pair::{PairMoments, PairPolarisation, PolarisablePair, PolarisedPairTable};
pub use relative_mobility::{PairModel, relative_axial_mobility};
pub use slip_force::SlipForce;
pub use slip_row::{LOADS, SLIP_NUMBERS, SLIP_ROW, SlipRow};
pub use sphere_motion::{SphereLoads, SphereMotion};
pub use sphere_row::{SPHERE_ROW, SphereRow};
pub use sphere_row_tables::SphereRowTables;
pub use surface_force::SurfaceForce;
pub use surface_slip::SurfaceSlip;
pub use wall_coefficients::WallCoefficients;
pub use wall_factor::WallFactor;
pub use wall_force::{WallForce, WallSlip};
