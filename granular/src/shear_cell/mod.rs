//! Frictional, inelastic spheres in a shear cell: flow along x (periodic), walls at the bottom and top (y) and at
//! both sides (z). The bottom and side walls move along x, the top wall is at rest.

mod cell_run;
mod contact;
mod engine;
mod event_driven;
mod grains;
mod measure;
mod memory;
mod packing;
mod parameters;
mod run;
mod tables;
mod tally;
mod time_stepped;
mod walls;

pub use crate::error::JammedPacking;
pub use cell_run::{CellRun, Experiment};
pub use contact::{CollisionRule, FrictionLaw, GrainMotion, INERTIA, Rebound, WallContact};
pub use engine::{CellState, CollisionDetection, CollisionEngine, Engine};
pub use event_driven::{EventDriven, Events};
pub use grains::Grains;
pub use measure::{Balance, CellSample, DensityMap, Layer, LayerProfile, WallStress};
pub use parameters::{CellModel, CellParameters, Top};
pub use run::{CellReport, Sampling, ShearCell};
pub use tally::{CellTally, WallTally};
pub use time_stepped::TimeStepped;
pub use walls::{Side, TopWall};
