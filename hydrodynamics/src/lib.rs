//! Hydrodynamics of rigid spheres: the far field of the force-coupling method and the resistance of near pairs, solved
//! together. Independent of scenes and models: from positions and loads to motions and stresslets.

pub mod ambient;
mod bodies;
mod body_projection;
pub mod brownian;
mod coupled_solver;
pub mod lengths;
pub mod memory;
mod mobility;
mod noise;
mod pairs;
mod preconditioner;
mod six_vector;
mod solution;
mod springs;
mod squirming;
mod system;
mod units;
mod unknowns;

pub use ambient::{FlowRefused, Poiseuille, StrainRate};
pub use bodies::{GivenMotion, RigidBodies};
pub use coupled_solver::{CoupledSolver, HeldContacts, ShortRange, TooManyContacts};
pub use mobility::memory::SingleEvaluation;
pub use mobility::overlaps::Overlaps;
pub use mobility::{Drift, Mobility, MobilityError, MobilityParameters, Motions};
pub use pairs::surface_laws::TakenForce;
pub use solution::{
    Guess, HeldFluctuations, HeldForces, HeldPrediction, KeptSolution, NO_AMBIENT, Solution, SolveInput, StoredSolution,
};
pub use springs::{BondSprings, ContactSprings, PairSprings, Springs, TetherResistance};
pub use squirming::{Squirming, SquirmingRefused};
