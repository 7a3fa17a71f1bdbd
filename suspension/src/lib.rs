//! Suspensions of spheres in Stokes flow: coupled far-field and near-field hydrodynamics, forces, background flow, time
//! integrators, observables and statistics. This crate reads and writes no files and prints nothing.
//!
//! A [`Force`] or [`PairLaw`] of the user is registered with [`Suspension::add_force`], an [`Observable`] with
//! [`SuspensionRun::add_observable`].
//!
//! Two spheres that settle side by side, in units of the radius, the viscosity and the Stokes velocity of a single
//! sphere (whose force is then `6 pi`):
//! ```
//! use domain::{Comm, PeriodicBox, Vector};
//! use suspension::{Model, Parameters, Species, Start, Suspension};
//!
//! let force = Vector::new(0.0, 0.0, -6.0 * std::f64::consts::PI);
//! let spheres = Species { force, ..Species::new("heavy", 1.0, 2) };
//! let cell = PeriodicBox::new(Vector::splat(32.0))?;
//! let places = vec![Vector::new(14.5, 16.0, 24.0), Vector::new(17.5, 16.0, 24.0)];
//! let start = Start::Positions(places);
//! let model = Model::new(Parameters { start, ..Parameters::new(cell, 1.0, vec![spheres], 0.1, 10) })?;
//! let mut suspension = Suspension::start(&model, &Comm::alone())?;
//! for _ in 0..3 {
//!     suspension.step()?;
//! }
//! let fallen = 24.0 - suspension.particles().positions[0].z;
//! assert!(fallen > suspension.clock().time(), "faster than one alone, which falls 0.91 a unit of time in such a box");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod benchmark;
mod bodies;
mod columns;
mod error;
mod evaluation;
mod flow;
mod forces;
mod forecast;
mod integrators;
mod model;
mod neighbourhood;
mod observables;
mod rotation;
mod run;
mod sampling;
mod scalars;
mod start;
mod suspension;
mod swimmers;

pub use columns::{ANGULAR_VELOCITY, BODY, ORIENTATION, STRESSLET, VELOCITY};
pub use error::step::StepError;
pub use error::{PlacingError, StartError};
pub use evaluation::stress::{ParticleStress, StressPart};
pub use evaluation::velocity_field::FluidVelocity;
pub use fcm::{Loads, Motion};
pub use forces::acting::{Acting, Configuration, Instant, Prediction, ResistanceFunction, Resistances, SolvedMotion};
pub use forces::force::{Force, StressName};
pub use forces::pairwise::{PairLaw, PairwiseForce};
pub use forces::tethers::BondTotals;
pub use forecast::Forecast;
pub use forecast::calibrate_repulsion::{LeastRepulsionError, least_repulsion};
pub use forecast::cost_growth::cost_growth;
pub use forecast::scaling::{AssumedNode, LATENCY, NODE, Scaling, StepAlone};
pub use forecast::stable_step::longest_step;
pub use forecast::summary::{Asked, outline, plan_values, predicted_memory};
pub use hydrodynamics::memory::Ranks;
pub use hydrodynamics::{
    BondSprings, ContactSprings, CoupledSolver, Drift, FlowRefused, GivenMotion, Guess, Mobility, MobilityError,
    MobilityParameters, Motions, Overlaps, ShortRange, SingleEvaluation, Solution, SolveInput, Springs,
    TetherResistance,
};
pub use lubrication::{Elasticity, PairKind};
pub use model::box_axes::UserAxes;
pub use model::radii::Radii;
pub use model::{
    ActiveDipole, Adaptive, AppliedField, Attraction, Axis, Beam, Bodies, BodyOrientation, Bonds, BrownianScheme,
    Centres, Contacts, Extension, FieldVariation, Filaments, Flow, Hydrodynamics, Integrator, Lattice, MAX_FRACTION,
    MAX_SPHERES, Model, MultipoleOrder, Orientation, Parameters, Protocol, RateChange, Repulsion, RestShape,
    ShearRates, SizeClass, SizeDistribution, Species, SphereMoment, Start, StatisticsParameters, Swimming, Trapped,
    Traps,
};
pub use neighbourhood::{NeighbourLists, PairsWithHalo, SeparatedPair};
pub use observables::NameTaken;
pub use observables::observable::{Observable, ObservedState};
pub use run::SuspensionRun;
pub use sampling::{COLUMNS as SAMPLE_COLUMNS, RankCounts, Sample, Statistics, column_bytes};
pub use suspension::{StepReport, Suspension};
