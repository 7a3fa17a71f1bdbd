//! The far field: spheres that exchange momentum with the fluid through Gaussian envelopes (the force-coupling method).
//!
//! A particle of radius `a` at `Y` applies the force density `f_i = F_i Delta + G_ij d_j Delta'` to the fluid, with
//! `G = S + A` made of its stresslet `S` and the antisymmetric part `A` of its torque, and moves with the fluid's
//! velocity averaged over the same envelopes. [`Mobility`] is that linear map from loads to motions; [`Hydrodynamics`]
//! adds the stresslets that keep spheres rigid.

mod accuracy;
mod boys;
mod burden;
mod check;
mod conjugate_gradients;
mod cost;
mod described;
mod envelope;
mod far;
mod gaussian;
mod hydrodynamics;
mod interpolate;
mod kernel;
mod loads;
mod memory;
mod mobility;
mod near;
mod pair_functions;
mod plan;
mod planner;
mod problem;
mod spread;
mod stencil;
mod table;
mod totals;
mod window;
mod work;

pub use conjugate_gradients::{Limits, Outcome, System, Unknowns, conjugate_gradients};
pub use cost::Costs;
pub use described::is_same_way;
pub use envelope::Envelope;
pub use hydrodynamics::{Hydrodynamics, SolveError, Solved};
pub use loads::{Loads, Motion};
pub use memory::Footprint;
pub use mobility::{Evaluation, Mobility};
pub use plan::{Plan, PlanError};
pub use problem::{Fixed, Method, MethodName, Multipoles, Precision, Problem};
pub use stencil::Support;
pub use work::{Seconds, Work};
