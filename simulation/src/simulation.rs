//! What runs step by step.

use crate::{Clock, Frame, LoadFunction, NoLoads, Quantity, State, TableSet, VelocityField};
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

    /// Tells it where to look for requests to stop. One whose steps may be long looks there within a step, and returns
    /// from [`Self::advance`] where that step began.
    fn listen(&mut self, _interrupt: Interrupt) {}

    /// Adds loads to those that act on the particles, from now on; [`NoLoads`] where they take none. `Err` on every rank
    /// or on none, and nothing is added then.
    fn add_loads(&mut self, _loads: LoadFunction) -> Result<(), SimulationError> {
        Err(SimulationError::new(NoLoads))
    }

    /// Takes a step, or as many as take no time worth speaking of, none of them beyond step `last`. `Err` on every rank
    /// or on none.
    fn advance(&mut self, last: u64) -> Result<(), SimulationError>;

    /// The particles now.
    fn frame(&self) -> Frame;

    /// What a row of the time series consists of.
    fn quantities(&self) -> Vec<Quantity>;

    /// A row of the time series: the numbers of each quantity in turn.
    fn observe(&mut self) -> Vec<Vec<f64>>;

    /// The numbers of a row as they are now, outside the time series: what is averaged from row to row goes on.
    fn look(&mut self) -> Vec<Vec<f64>> {
        self.observe()
    }

    /// Takes what is averaged from the step where it is.
    fn sample(&mut self) {}

    /// The state, from which it goes on bit for bit.
    fn state(&mut self) -> State;

    /// The velocity of the fluid, if there is one.
    fn velocity_field(&mut self) -> Result<Option<VelocityField>, SimulationError> {
        Ok(None)
    }

    /// Averages over the run so far, if it has some.
    fn averages(&mut self) -> Option<TableSet> {
        None
    }

    /// What the user should know of it at the start.
    fn cautions(&self) -> Vec<String> {
        Vec::new()
    }

    /// What the user should know of it at the end.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}
