//! Interface of all simulations that are advanced in time steps, so that a program, a test or another language runs
//! every kind in the same way.
//!
//! A quantity of the time series is a number or a table with names, in a unit of length, time and force:
//! ```
//! use simulation::{Clock, Quantity};
//!
//! let stress = Quantity::vectors("mean_velocity", "length/time", &["heavy".to_owned()]);
//! assert_eq!(stress.columns(), ["mean_velocity_x[heavy]", "mean_velocity_y[heavy]", "mean_velocity_z[heavy]"]);
//!
//! let mut clock = Clock::at(0, 0.25);
//! clock.tick();
//! assert_eq!((clock.step(), clock.time()), (1, 0.25));
//! ```

mod clock;
mod contact_forces;
mod csv;
mod frame;
mod loads;
mod neighbour_list;
mod outline;
mod quantity;
mod rearrangement;
mod schedule;
mod settled_parameter;
mod simulation;
mod state;
mod table;
mod velocity_field;

pub use clock::Clock;
pub use contact_forces::{ContactForce, ContactForces, ContactState};
pub use csv::{csv_cell, csv_line, csv_words};
pub use frame::Frame;
pub use loads::{AppliedLoads, LoadFunction, NoLoads, PairForceFunction, UserLoads};
pub use neighbour_list::{CutoffError, NeighbourList};
pub use outline::Outline;
pub use quantity::Quantity;
pub use rearrangement::{Rearrangement, RearrangementError};
pub use schedule::Schedule;
pub use settled_parameter::SettledParameter;
pub use simulation::{Simulation, SimulationError};
pub use state::State;
pub use table::{Table, TableSet};
pub use velocity_field::VelocityField;
