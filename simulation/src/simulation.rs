//! Trait of simulations that are advanced in time steps.

use crate::{
    Clock, ContactForces, CutoffError, Frame, NeighbourList, NoLoads, Quantity, Rearrangement, SettledParameter, State,
    TableSet, UserLoads, VelocityField,
};
use domain::{Comm, Interrupt};
use std::error::Error;

/// Reason why a simulation can't continue.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct SimulationError(Box<dyn Error + Send + Sync>);

impl SimulationError {
    /// Wraps the error of one kind of simulation.
    pub fn new(error: impl Error + Send + Sync + 'static) -> Self {
        Self(Box::new(error))
    }
}

/// A simulation advanced in time steps. Every call is collective; results that are written are those of the first
/// rank.
pub trait Simulation {
    /// Communicator of the ranks.
    fn comm(&self) -> &Comm;

    /// Step and time.
    fn clock(&self) -> &Clock;

    /// Description of how the fluid is computed.
    fn plan(&mut self) -> String;

    /// Sets the flag by which the simulation is asked to stop. A simulation whose steps can be long checks it within
    /// a step; [`Self::advance`] then returns with the state at the start of that step.
    fn listen(&mut self, _interrupt: Interrupt) {}

    /// Adds loads to those that act on the particles, from now on; [`NoLoads`] where they take none. `Err` on every
    /// rank or on none, and nothing is added then.
    fn add_loads(&mut self, _loads: UserLoads) -> Result<(), SimulationError> {
        Err(SimulationError::new(NoLoads))
    }

    /// Takes one step, or several if steps are very short, but none beyond step `last`, the next one at which the
    /// particles' motions are needed. `Err` on every rank or on none.
    fn advance(&mut self, last: u64) -> Result<(), SimulationError>;

    /// Present particles, all on the first rank in the order of their ids.
    fn frame(&self) -> Frame;

    /// The same without gathering: each rank with its own particles, in any order.
    fn frame_share(&self) -> Frame {
        self.frame()
    }

    /// The pairs of particles whose centres are nearer than a cutoff, on the first rank. `Err` on every rank or on
    /// none.
    fn neighbours(&self, cutoff: f64) -> Result<NeighbourList, CutoffError> {
        let Frame { particles, cell, periodic } = self.frame();
        NeighbourList::find(&particles, &cell, periodic, cutoff)
    }

    /// The quantities of the time series.
    fn quantities(&self) -> Vec<Quantity>;

    /// A row of the time series: the numbers of each quantity in turn.
    fn observe(&mut self) -> Vec<Vec<f64>>;

    /// Present numbers of a row, not for the time series: averages since its last row continue.
    fn present_row(&mut self) -> Vec<Vec<f64>> {
        self.observe()
    }

    /// Takes a sample for the averages at the present step.
    fn sample(&mut self) {}

    /// State for a checkpoint, from which a run continues bit for bit, on each rank with its own particles.
    fn state(&mut self) -> State;

    /// A state of this simulation, or of another of the same kind, in which a user has changed some values. Nothing is
    /// left in it of how the particles moved before, and what follows from their places is to be computed again. `Err`
    /// on every rank or on none.
    fn rearranged(&self, state: State, change: &Rearrangement) -> Result<State, SimulationError>;

    /// The velocity of the fluid, if there is one.
    fn velocity_field(&mut self) -> Result<Option<VelocityField>, SimulationError> {
        Ok(None)
    }

    /// Contact forces between particles, if the simulation has contacts.
    fn contact_forces(&self) -> Option<ContactForces> {
        None
    }

    /// Averages over the run so far, if there are any.
    fn averages(&mut self) -> Option<TableSet> {
        None
    }

    /// Parameter of the scene that the run has determined, once it is known.
    fn settled_parameter(&self) -> Option<SettledParameter> {
        None
    }

    /// Reason why the run has ended before its last step, if it has.
    fn end_reason(&self) -> Option<String> {
        None
    }

    /// Progress, from 0 to 1, towards a condition that ends the run before its last step, such as a strain; `None` if
    /// only the number of steps ends it.
    fn progress(&self) -> Option<f64> {
        None
    }

    /// Warnings for the user at the start.
    fn start_warnings(&self) -> Vec<String> {
        Vec::new()
    }

    /// Warnings for the user at the end.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}
