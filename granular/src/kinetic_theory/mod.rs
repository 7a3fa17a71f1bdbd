//! The continuum shear cell: kinetic theory of nearly elastic spheres between two parallel walls, the lower of which
//! slides at the speed `U` while a normal stress `P` presses the upper one down. The gap `H` is given.
//!
//! Steady balances of momentum and energy, with solid fraction `v(y)`, velocity `u(y)` and granular temperature
//! `T = P / C2(v)` (Yu and Tichy 2001, eqs 6 to 15):
//!
//! ```text
//! C1 sqrt(T) |u'| = S = const,   q = K T^(3/2) v',   q' = S |u'| - C6 T^(3/2)
//! |u'| = R5 B5 u_slip,   dv/dn = R7 B7 u_slip^2 + R8 B8 u_slip |u'| - R6 B6   at both walls
//! ```
//!
//! The functions C1 to C6 are those of Lun, Savage, Jeffrey and Chepurniy 1984, the wall laws those of Jenkins and
//! Richman 1986. [`ContinuumProblem`] checks the input, [`ContinuumProblem::solve`] returns a [`ContinuumSolution`] or
//! says where it failed.

mod collocation;
mod constitutive;
mod equations;
mod jet;
mod linear;
mod problem;
mod radial;
mod solution;
mod solve;
mod uniform;
mod wall;

pub use constitutive::{GrainProperties, StressFunctions};
pub use jet::Jet;
pub use problem::{ContinuumParameters, ContinuumProblem, SolutionStart};
pub use radial::RadialDistribution;
pub use solution::{ContinuumSolution, FlowPoint};
pub use solve::ContinuumError;
pub use uniform::UniformFlow;
pub use wall::{BumpIntegrals, Roughness, Wall, WallShape};
