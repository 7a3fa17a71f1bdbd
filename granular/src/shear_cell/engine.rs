//! The two engines, time-stepped and event-driven, behind one interface.

use super::{EventDriven, Grains, Lid, Model, Tally, TimeStepped};
use crate::parameter::{ParameterError, require};
use domain::Vector;

/// Method of collision detection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Collisions {
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
pub struct State {
    /// The grains.
    pub grains: Grains,
    /// The top wall.
    pub lid: Lid,
    /// Sums so far.
    pub tally: Tally,
}

impl State {
    /// Grains at the start of a run.
    pub fn new(model: &Model, grains: &Grains) -> Self {
        Self { grains: grains.clone(), lid: Lid::new(model), tally: Tally::default() }
    }

    /// Refuses grains that are outside the cell or have a speed that is not finite.
    pub(super) fn check(&self, model: &Model) -> Result<(), ParameterError> {
        let (positions, motions) = (&self.grains.positions, &self.grains.motions);
        let found = format!("{} values", motions.len());
        require(positions.len() == motions.len(), "velocity", &found, format!("one for each of {}", positions.len()))?;
        let edges = Vector { y: self.lid.height, ..model.edges() };
        // A grain may overlap a wall, by half its radius at most.
        let margin = Vector::from(std::array::from_fn(|k| if model.is_walled(k) { 0.5 * model.radius() } else { 0.0 }));
        for (x, motion) in positions.iter().zip(motions) {
            let inside = x.cmpge(margin).all() && x.cmple(edges - margin).all();
            require(inside, "position", x, "a centre inside the cell, a radius from its walls")?;
            let finite = motion.velocity.is_finite() && motion.spin.is_finite();
            require(finite, "velocity", &motion.velocity, "finite numbers")?;
        }
        Ok(())
    }
}

/// One of the two engines.
pub enum Engine {
    /// With a fixed time step.
    TimeStepped(Box<TimeStepped>),
    /// From event to event.
    EventDriven(Box<EventDriven>),
}

impl Engine {
    /// Starts from grains inside the cell; the event-driven engine needs them not to overlap.
    pub fn new(model: &Model, grains: &Grains, collisions: Collisions) -> Result<Self, ParameterError> {
        Self::resume(model, &State::new(model, grains), collisions)
    }

    /// Resumes from a state.
    pub fn resume(model: &Model, state: &State, collisions: Collisions) -> Result<Self, ParameterError> {
        Ok(match collisions {
            Collisions::TimeStepped { step } => Self::TimeStepped(Box::new(TimeStepped::new(model, state, step)?)),
            Collisions::EventDriven => Self::EventDriven(Box::new(EventDriven::new(model, state)?)),
        })
    }

    /// The present state. The engine is restarted from it, like one that resumes from a checkpoint, so that both
    /// continue with the same bits.
    pub fn checkpoint(&mut self, model: &Model) -> Result<State, ParameterError> {
        let state = State { grains: self.grains(), lid: self.lid(), tally: *self.tally() };
        *self = Self::resume(model, &state, self.collisions()).map_err(|error| self.cause(error))?;
        Ok(state)
    }

    /// The cause of a failure: for the time-stepped engine, a time step that is too long.
    fn cause(&self, error: ParameterError) -> ParameterError {
        match self {
            Self::TimeStepped(engine) => engine.too_long(),
            Self::EventDriven(_) => error,
        }
    }

    /// The error of an engine that stopped early because of its time step.
    pub fn failure(&self) -> Option<ParameterError> {
        match self {
            Self::TimeStepped(engine) => engine.has_escaped().then(|| engine.too_long()),
            Self::EventDriven(_) => None,
        }
    }

    /// Method of collision detection of this engine.
    pub fn collisions(&self) -> Collisions {
        match self {
            Self::TimeStepped(engine) => Collisions::TimeStepped { step: engine.step() },
            Self::EventDriven(_) => Collisions::EventDriven,
        }
    }

    /// Runs for a duration, rounded to whole time steps by the time-stepped engine, while the grains are not jammed
    /// and `go_on`, which is called several times a second, returns true. Returns whether it reached the end.
    pub fn advance(&mut self, duration: f64, go_on: &dyn Fn() -> bool) -> bool {
        match self {
            Self::TimeStepped(engine) => engine.advance((duration / engine.step()).round() as u64, go_on),
            Self::EventDriven(engine) => engine.advance(duration, go_on),
        }
    }

    /// Whether rigid grains have jammed, so that the engine stopped early.
    pub fn is_jammed(&self) -> bool {
        match self {
            Self::TimeStepped(_) => false,
            Self::EventDriven(engine) => engine.is_jammed(),
        }
    }

    /// The grains now.
    pub fn grains(&self) -> Grains {
        match self {
            Self::TimeStepped(engine) => engine.grains(),
            Self::EventDriven(engine) => engine.grains(),
        }
    }

    /// Sums so far.
    pub fn tally(&self) -> &Tally {
        match self {
            Self::TimeStepped(engine) => engine.tally(),
            Self::EventDriven(engine) => engine.tally(),
        }
    }

    /// The top wall.
    pub fn lid(&self) -> Lid {
        match self {
            Self::TimeStepped(engine) => engine.lid(),
            Self::EventDriven(engine) => engine.lid(),
        }
    }
}
