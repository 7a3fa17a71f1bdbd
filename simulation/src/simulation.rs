//! The trait of simulations that are advanced in time steps.

use crate::{
    Clock, ContactForces, CutoffError, Found, Frame, NeighbourList, NoLoads, OwnLoads, Quantity, Rearrangement, State,
    TableSet, VelocityField,
};
use domain::{Comm, Interrupt};
use std::error::Error;

/// Why a simulation can't go on.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct SimulationError(Box<dyn Error + Send + Sync>);

impl SimulationError {
    /// From the error of one kind of simulation.
    pub fn new(error: impl Error + Send + Sync + 'static) -> Self {
        Self(Box::new(error))
    }
}

/// A simulation advanced in time steps. Every call is collective; what is written is that of the first rank.
pub trait Simulation {
    /// The ranks.
    fn comm(&self) -> &Comm;

    /// The time.
    fn clock(&self) -> &Clock;

    /// How it is computed, in words.
    fn plan(&mut self) -> String;

    /// Sets the flag by which it is asked to stop. A simulation whose steps can be long checks it within a step;
    /// [`Self::advance`] then returns with the state at the start of that step.
    fn listen(&mut self, _interrupt: Interrupt) {}

    /// Adds loads to those that act on the particles, from now on; [`NoLoads`] where they take none. `Err` on every rank
    /// or on none, and nothing is added then.
    fn add_loads(&mut self, _loads: OwnLoads) -> Result<(), SimulationError> {
        Err(SimulationError::new(NoLoads))
    }

    /// Takes one step, or several where steps are very short, but none beyond step `last`, which is the next at which anybody
    /// looks at the particles' motions. `Err` on every rank or on none.
    fn advance(&mut self, last: u64) -> Result<(), SimulationError>;

    /// The particles now, all on the first rank in the order of their ids.
    fn frame(&self) -> Frame;

    /// The same without a rank that has all: each with its own particles, in any order.
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

    /// The present numbers of a row, not for the time series: averages since its last row go on.
    fn look(&mut self) -> Vec<Vec<f64>> {
        self.observe()
    }

    /// Takes a sample for the averages at the present step.
    fn sample(&mut self) {}

    /// The state for a checkpoint, from which a run continues bit for bit, on each rank with its own particles.
    fn state(&mut self) -> State;

    /// A state of this simulation, or of another of the same kind, in which a user has changed some values. Nothing is
    /// left in it of how the particles moved before, and what follows from their places is to be computed again. `Err`
    /// on every rank or on none.
    fn rearranged(&self, state: State, change: &Rearrangement) -> Result<State, SimulationError>;

    /// The velocity of the fluid, if there is one.
    fn velocity_field(&mut self) -> Result<Option<VelocityField>, SimulationError> {
        Ok(None)
    }

    /// Forces between particles that touch, if they can.
    fn contact_forces(&self) -> Option<ContactForces> {
        None
    }

    /// Averages over the run so far, if it takes any.
    fn averages(&mut self) -> Option<TableSet> {
        None
    }

    /// A number of its scene that it has found in its course, once it is known.
    fn found(&self) -> Option<Found> {
        None
    }

    /// Why there is nothing more to come, if it has come to an end before its last step.
    fn ended(&self) -> Option<String> {
        None
    }

    /// The part that is done of what ends it before its last step, from 0 to 1, such as a strain; nothing where only steps end it.
    fn part_done(&self) -> Option<f64> {
        None
    }

    /// Warnings for the user at the start.
    fn cautions(&self) -> Vec<String> {
        Vec::new()
    }

    /// Warnings for the user at the end.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}
