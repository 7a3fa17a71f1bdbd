//! Simulations that are advanced in time steps: what all kinds of them have in common, so that a program, a test or
//! another language runs them alike.

mod clock;
mod frame;
mod outline;
mod quantity;
mod schedule;
mod simulation;
mod state;
mod table;
mod velocity_field;

pub use clock::Clock;
pub use frame::Frame;
pub use outline::Outline;
pub use quantity::Quantity;
pub use schedule::Schedule;
pub use simulation::{Simulation, SimulationError};
pub use state::State;
pub use table::{Table, TableSet};
pub use velocity_field::VelocityField;
