//! Granular flows without a fluid grid, in three modules that do not import each other:
//!
//! - [`disks`]: disks in a plane with soft contacts, sheared by a liquid that drags them;
//! - [`shear_cell`]: frictional hard spheres between walls, with an event-driven and a time-stepped engine;
//! - [`kinetic_theory`]: the continuum model of that cell, solved by collocation.
//!
//! Both particle models are [`simulation::Simulation`]s on the particle store of `domain`; `statistics` averages them.
//!
//! Sheared disks, in units of the mean radius, the mass of a disk of that radius, and the contact time over pi:
//! ```
//! use granular::disks::{Disks, DiskModel, DiskParameters, Preparation};
//!
//! let preparation = Preparation { settled: 3.0, mixed: 6.0, ..DiskParameters::default().preparation };
//! let parameters = DiskParameters { edges: [30.0; 2], area_fraction: 0.5, preparation, ..DiskParameters::default() };
//! let mut disks = Disks::prepared(&DiskModel::new(parameters)?)?;
//! disks.advance(20);
//! assert!((disks.strain() - 20.0 * 0.15 * 0.01).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod disks;
mod error;
mod fraction;
pub mod kinetic_theory;
mod parameter;
pub mod shear_cell;

pub use error::GrainStartError;
pub use parameter::ParameterError;
