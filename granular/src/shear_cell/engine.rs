//! The two engines, time-stepped and event-driven, behind one interface.

use super::{CellModel, CellTally, EventDriven, Grains, TimeStepped, TopWall};
use crate::parameter::{Components, ParameterError, require};
use domain::Vector;

/// Method of collision detection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CollisionDetection {
    /// With a fixed time step, as in the paper.
    TimeStepped {
        /// Time step; the paper's is 0.5 us.
        step: f64,
    },
    /// At the exact times of contact.
    EventDriven,
}

/// The state of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct CellState {
    /// The grains.
    pub grains: Grains,
    /// The top wall.
    pub top_wall: TopWall,
    /// Sums so far.
    pub tally: CellTally,
}

impl CellState {
    /// Grains at the start of a run.
    pub fn new(model: &CellModel, grains: &Grains) -> Self {
        Self { grains: grains.clone(), top_wall: TopWall::new(model), tally: CellTally::default() }
    }

    /// Refuses grains that are outside the cell or have a speed that is not finite.
    pub(super) fn check(&self, model: &CellModel) -> Result<(), ParameterError> {
        let (positions, motions) = (&self.grains.positions, &self.grains.motions);
        let found = format_args!("{} values", motions.len());
        let allowed = format_args!("one for each of {}", positions.len());
        require(positions.len() == motions.len(), "velocity", found, allowed)?;
        let edges = Vector { y: self.top_wall.height, ..model.edges() };
        // A grain may overlap a wall, by half its radius at most.
        let margin = Vector::from(std::array::from_fn(|k| if model.is_walled(k) { 0.5 * model.radius() } else { 0.0 }));
        for (x, motion) in positions.iter().zip(motions) {
            let inside = x.cmpge(margin).all() && x.cmple(edges - margin).all();
            require(inside, "position", Components(x.to_array()), "a centre inside the cell, a radius from its walls")?;
            let finite = motion.velocity.is_finite() && motion.spin.is_finite();
            require(finite, "velocity", Components(motion.velocity.to_array()), "finite numbers")?;
        }
        Ok(())
    }
}

/// A method by which grains fly and collide.
pub trait CollisionEngine {
    /// Method of collision detection.
    fn collisions(&self) -> CollisionDetection;

    /// Runs for a duration, rounded to whole time steps by the time-stepped engine, while nothing fails, the grains are
    /// not jammed, and `may_continue`, which is called several times a second, returns true. Returns whether it reached
    /// the end.
    fn advance(&mut self, duration: f64, may_continue: &dyn Fn() -> bool) -> bool;

    /// The error of an engine that stopped early because of its time step.
    fn failure(&self) -> Option<ParameterError> {
        None
    }

    /// The cause of an error of the present state: for the time-stepped engine, a time step that is too long.
    fn cause(&self, error: ParameterError) -> ParameterError {
        error
    }

    /// Whether rigid grains have jammed, so that the engine stopped early: their collision rate grows without bound.
    fn is_jammed(&self) -> bool {
        false
    }

    /// The grains now.
    fn grains(&self) -> Grains;

    /// Sums so far.
    fn tally(&self) -> &CellTally;

    /// The top wall.
    fn top_wall(&self) -> TopWall;

    /// All of them.
    fn state(&self) -> CellState {
        CellState { grains: self.grains(), top_wall: self.top_wall(), tally: *self.tally() }
    }
}

/// Either of the two engines.
pub type Engine = dyn CollisionEngine;

impl Engine {
    /// Starts from grains inside the cell; the event-driven engine needs them not to overlap.
    pub fn new(
        model: &CellModel,
        grains: &Grains,
        collisions: CollisionDetection,
    ) -> Result<Box<Self>, ParameterError> {
        Self::resume(model, &CellState::new(model, grains), collisions)
    }

    /// Resumes from a state.
    pub fn resume(
        model: &CellModel,
        state: &CellState,
        collisions: CollisionDetection,
    ) -> Result<Box<Self>, ParameterError> {
        Ok(match collisions {
            CollisionDetection::TimeStepped { step } => Box::new(TimeStepped::new(model, state, step)?),
            CollisionDetection::EventDriven => Box::new(EventDriven::new(model, state)?),
        })
    }

    /// The present state. The engine is restarted from it, like one that resumes from a checkpoint, so that both
    /// continue with the same bits.
    pub fn checkpoint(self: &mut Box<Self>, model: &CellModel) -> Result<CellState, ParameterError> {
        let state = self.state();
        *self = Self::resume(model, &state, self.collisions()).map_err(|error| self.cause(error))?;
        Ok(state)
    }
}
