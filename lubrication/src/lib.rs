//! The near field of particles in Stokes flow: exact two-sphere functions, lubrication, repulsion.

mod barrier;
mod blocks;
mod chebyshev;
mod dense;
mod far_field;
#[cfg(test)]
mod free_pair;
mod gaussian;
mod memory;
mod opening;
mod pair_factor;
mod pair_force;
mod pair_motion;
mod range;
mod rigid_resistance;
mod root;
mod root_table;
pub mod two_sphere;

pub use barrier::{Barrier, BarrierError};
pub use opening::{Detail, opening_mobility};
pub use pair_factor::PairFactor;
pub use pair_force::{PairForce, PairForceError};
pub use pair_motion::{PairLoads, PairMotion};
pub use range::{Range, RangeError};
pub use rigid_resistance::RigidResistance;
