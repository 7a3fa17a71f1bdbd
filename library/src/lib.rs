//! The names that a short program needs, from the crates that define them: mobilities of spheres at given positions,
//! and suspensions that advance in time. Neither needs files, HDF5 or MPI.
//!
//! The mobility of two spheres, of which one is pulled along the line of centres:
//! ```
//! use fcm_solve_library::{BackgroundFlow, Bytes, Comm, Loads, Mobility, MobilityParameters, PeriodicBox, Vector};
//!
//! let cell = PeriodicBox::new(Vector::splat(40.0))?;
//! let parameters = MobilityParameters::new(cell, 1.0, vec![1.0, 1.0]);
//! let mut mobility = Mobility::new(parameters, Bytes::default(), &Comm::alone())?;
//! mobility.place(&[Vector::splat(20.0), Vector::new(23.0, 20.0, 20.0)])?;
//! let pull = Vector::new(6.0 * std::f64::consts::PI, 0.0, 0.0);
//! let loads = Loads { forces: vec![pull, Vector::ZERO], ..Loads::default() };
//! let motion = mobility.apply(&loads, &BackgroundFlow::NONE)?.motion;
//! let [pulled, dragged] = [motion.velocities[0].x, motion.velocities[1].x];
//! assert!(0.8 < pulled && pulled < 1.0, "alone in unbounded fluid: 1");
//! assert!(0.3 < dragged && dragged < 0.5 * pulled);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Random spheres that settle, in units of the radius, the viscosity and the Stokes velocity:
//! ```
//! use fcm_solve_library::{Comm, Model, Parameters, PeriodicBox, Species, Suspension, Vector};
//!
//! let cell = PeriodicBox::new(Vector::splat(16.0))?;
//! let force = Vector::new(0.0, 0.0, -6.0 * std::f64::consts::PI);
//! let spheres = Species { force, ..Species::new("heavy", 1.0, 20) };
//! let (time_step, steps) = (0.1, 10);
//! let model = Model::new(Parameters::new(cell, 1.0, vec![spheres], time_step, steps))?;
//! let mut suspension = Suspension::start(&model, &Comm::alone())?;
//! for _ in 0..3 {
//!     suspension.step()?;
//! }
//! let velocities = suspension.velocities_in_flow();
//! let mean = velocities.iter().map(|velocity| velocity.z).sum::<f64>() / velocities.len() as f64;
//! assert!(-1.0 < mean && mean < 0.0, "slower than a single sphere, whose velocity is -1");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use domain::{Bytes, Comm, Particles, PeriodicBox, Tensor, Traceless, Vector};
pub use fcm::{Loads, Motion};
pub use hydrodynamics::{Mobility, MobilityParameters};
pub use lubrication::LubricationRange;
pub use solver::BackgroundFlow;
pub use suspension::{Contacts, Flow, Model, Parameters, Repulsion, Species, Start, Suspension};
