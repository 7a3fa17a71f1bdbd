//! Suspensions of spheres in Stokes flow: far and near field of the fluid together, forces, background flow, integrators,
//! and what is observed and averaged. Nothing here reads or writes files, or prints.
//!
//! Two spheres that settle side by side, in units of the radius, of the viscosity and of the Stokes velocity of one
//! (whose force is then `6 pi`):
//! ```
//! use domain::{Comm, PeriodicBox, Vector};
//! use suspension::{Model, Parameters, Species, Start, Suspension};
//!
//! let spheres = Species { force: Vector::new(0.0, 0.0, -6.0 * std::f64::consts::PI), ..Species::new("heavy", 1.0, 2) };
//! let cell = PeriodicBox::new(Vector::splat(32.0))?;
//! let places = vec![Vector::new(14.5, 16.0, 24.0), Vector::new(17.5, 16.0, 24.0)];
//! let start = Start::Positions(places);
//! let model = Model::new(Parameters { start, ..Parameters::new(cell, 1.0, vec![spheres], (0.1, 10)) })?;
//! let mut suspension = Suspension::start(&model, &Comm::alone())?;
//! for _ in 0..3 {
//!     suspension.step()?;
//! }
//! let fallen = 24.0 - suspension.particles().positions[0].z;
//! assert!(fallen > suspension.clock().time(), "faster than one alone, which falls 0.91 a unit of time in such a box");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adaptive;
mod applied;
mod averages;
pub mod benchmark;
mod brownian;
mod cautions;
mod channel_flow;
mod cloud;
mod columns;
mod contacts;
mod course;
mod crowding;
mod deformation;
mod driven;
mod dynamics;
mod error;
mod extrapolation;
mod fluid;
mod forces;
mod forecast;
mod gap;
mod given_positions;
mod hydrodynamics;
mod implicit;
mod initial;
mod integrator;
mod least_repulsion;
mod lengths;
mod memory;
mod migration;
mod mobility;
mod model;
mod moving_box;
mod near;
mod observe;
mod observed;
mod open_box;
mod orders;
mod outline;
mod overlaps;
mod plan;
mod poiseuille;
mod pressure_flow;
mod random_motion;
mod rearranged;
mod relative_motion;
mod rheology;
mod sampling;
mod scaling;
mod setup;
mod single_evaluation;
mod steadiness;
mod step_error;
mod step_lengths;
mod strain_rate;
mod stress;
mod stretching;
mod substeps;
mod suspension;
mod tethers;
mod user_axes;
mod warm_start;

pub use channel_flow::FlowRefused;
pub use columns::{ANGULAR_VELOCITY, STRESSLET, VELOCITY};
pub use course::course;
pub use error::{PlacingError, StartError};
pub use fluid::FluidVelocity;
pub use forecast::Forecast;
pub use hydrodynamics::{
    Acting, ContactSprings, Guess, Hydrodynamics as CoupledHydrodynamics, ShortRange, Solved, Springs,
};
pub use least_repulsion::{LeastRepulsionError, least_repulsion};
pub use lubrication::Elasticity;
pub use memory::Ranks;
pub use mobility::{Drift, Mobility, MobilityError, MobilityParameters, Motions};
pub use model::{
    Adaptive, Attraction, Axis, Bonds, BrownianScheme, Centres, Contacts, Evaluation, Extension, Flow, Hydrodynamics,
    Integrator, Lattice, MAX_FRACTION, MAX_SPHERES, Model, Multipoles, Parameters, Protocol, RateChange, Repulsion,
    ShearRates, SizeClass, SizeDistribution, Species, Start, Statistics as StatisticsWanted, Trapped, Traps,
};
pub use observed::Observed;
pub use outline::{Asked, outline, plan_values, predicted_memory};
pub use overlaps::Overlaps;
pub use sampling::{COLUMNS as SAMPLE_COLUMNS, OfRank as StatisticsOfRank, Sample, Statistics, column_bytes};
pub use scaling::{BANDWIDTH, LATENCY, Scaling, StepAlone};
pub use single_evaluation::SingleEvaluation;
pub use steadiness::longest_step;
pub use step_error::StepError;
pub use stress::ParticleStress;
pub use suspension::{StepReport, Suspension};
pub use tethers::{BondSprings, TetherResistance};
pub use user_axes::UserAxes;
