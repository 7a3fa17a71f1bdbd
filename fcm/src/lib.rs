//! Far field of the force-coupling method: spheres exchange momentum with the fluid through Gaussian envelopes.
//!
//! A particle of radius `a` at `Y` applies the force density `f_i = F_i Delta + G_ij d_j Delta'` to the fluid, where
//! `G = S + A` is the sum of its stresslet `S` and the antisymmetric part `A` by its torque. It moves with the
//! fluid's velocity averaged over the same envelopes. [`Mobility`] is that linear map from loads to motions;
//! [`StressletSolver`] adds the stresslets that keep spheres rigid.
//!
//! Units are any consistent ones. The velocity of a sphere in a periodic box of 32 radii, over its Stokes velocity
//! `F / (6 pi mu a)`, is `1 - 2.8373 a/L + 4.19 (a/L)^3` (Hasimoto 1959):
//! ```
//! use domain::{Boundaries, Comm, Particles, Partition, PeriodicBox, Traceless, Vector};
//! use fcm::{Costs, Fixed, Loading, Loads, Multipoles, Plan, Problem, StressletSolver};
//!
//! let (radius, edge, viscosity) = (1.0, 32.0, 1.0);
//! let plan = Plan::choose(&Problem {
//!     edges: Vector::splat(edge),
//!     boundaries: Boundaries::Periodic,
//!     volume: edge.powi(3),
//!     shortest_vector: edge,
//!     smallest_edge_ratio: 1.0,
//!     largest_strain: 0.0,
//!     largest_tilts: [0.0; 2],
//!     radii: vec![(radius, 1)],
//!     viscosity,
//!     multipoles: Multipoles::Dipole,
//!     rigid: true,
//!     lubricated: false,
//!     loading: Loading::Uniform,
//!     tolerance: 1e-4,
//!     threads: 1,
//!     ranks: 1,
//!     costs: Costs::default(),
//!     network: None,
//!     fixed: Fixed::default(),
//! })?;
//! let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
//! let mut sphere = Particles::default();
//! sphere.push(0, Vector::splat(3.0), radius, 0);
//! let weight = 6.0 * std::f64::consts::PI * viscosity * radius;
//! let loads = Loads { forces: vec![Vector::new(0.0, 0.0, weight)], ..Loads::default() };
//! let mut hydrodynamics = StressletSolver::new(&plan, &partition);
//! let solved = hydrodynamics.solve(&plan.cell(), &sphere, &loads, Traceless::default(), &[])?;
//! let expected = 1.0 - 2.8373 / edge + 4.19 / edge.powi(3);
//! assert!((solved.motion.velocities[0].z - expected).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The modules, each of which imports those before it: `grid` spreads and interpolates; `pairs` has the pair
//! corrections; `plan` the problem, its plan and the identity of plans; `walls` the images in walls; `mobility` the
//! map itself, by one of the back ends in `mobility/far_field`; `rigid` the solve for stresslets; `dipoles` the fields
//! of magnetic or electric moments, by the grids and pairs of the others.

mod conjugate_gradients;
mod dipoles;
mod envelope;
mod grid;
mod lanczos;
mod mobility;
mod pairs;
mod plan;
mod rigid;
mod walls;

pub use conjugate_gradients::{
    InnerProducts, Iterate, IterationOutcome, Limits, Linear, Step, System, conjugate_gradients,
};
pub use dipoles::{DipoleError, DipoleField, DipoleProblem, DipoleSolution, Magnetisation};
pub use envelope::{Envelope, Quadrupole};
pub use gpu::{
    CloseSpheres, ContactLaw, GUESSED, NearInput, NearKind, NearTables, PAST, PairRows, SurfaceKind, SurfaceLaws,
    SurfacePair, WALL_NUMBERS,
};
pub use grid::stencil::Support;
pub use lanczos::{DrawDiagnostics, LanczosLimits, square_root_times};
pub use mobility::contacts::{ContactFarField, TouchingParticles};
pub use mobility::coupled::{
    ChangeLimits, ChangedSolution, CoupledFarField, CoupledProblem, CoupledResidual, CoupledSolution,
    CoupledTolerances, GivenAmbient, GivenLoads, HeldLoads, HeldSprings, KnownSolution, MovingFlow,
    PredictedVelocities, SolutionColumns,
};
pub use mobility::fluctuating::{
    ExactConditions, FluctuatingFarField, HeldDraw, HeldMotions, HeldSolution, LoadDraw, SolutionChange,
};
pub use mobility::loads::{Loads, Motion, Output};
pub use mobility::memory::Footprint;
pub use mobility::noise::Stream;
pub use mobility::past_solutions::{PastNumbers, PastSolutions};
pub use mobility::rank_one::Constraint;
pub use mobility::stepping::{
    DISPLACED, DisplacementError, DisplacementOrders, DisplacementWeights, GapChanges, HeldSteps, HeldVelocities,
    Separation, SeparationLimits,
};
pub use mobility::work::{Seconds, Work};
pub use mobility::{Flow, Mobility, SurfaceFarField};
#[doc(hidden)]
pub use plan::accuracy;
pub use plan::bounded::{NEAREST_WALL, OutsideError, check_inside};
pub use plan::costs::Costs;
pub use plan::device::{CardMemory, CardRanks, CardSteps, ComputeDevice, NearPairCounts};
pub use plan::method::{Method, Split};
pub use plan::network::{Network, Traffic};
pub use plan::plan_identity::PlanIdentity;
pub use plan::problem::{Fixed, Loading, Multipoles, Precision, Problem};
pub use plan::sample_points::SamplePoints;
pub use plan::{Plan, PlanError};
pub use rigid::stresslet_solver::{RigidInput, SolveError, Solved, StressletSolver};
