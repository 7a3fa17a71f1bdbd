//! What is averaged in the course of a run.

use domain::{Boundaries, Number, ParameterError, PeriodicBox};
use simulation::Schedule;

/// What is averaged in the course of a run, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    /// When samples are taken.
    pub samples: Schedule,
    /// The time of the first sample.
    pub from: f64,
    /// The largest distance of pairs whose distribution is wanted; 8 of the largest radius where there is none.
    pub distance: Option<f64>,
    /// The axis of concentration and segregation; that of the forces or of the gradient where there is none.
    pub axis: Option<Axis>,
    /// How many bins there are across a channel; four to the smallest radius where there is no number.
    pub bins: Option<usize>,
    /// The time lag from which motion is diffusive; a quarter of the time taken in where there is none.
    pub diffusive_from: Option<f64>,
}

/// An axis of the box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Along the flow.
    X,
    /// Along the gradient.
    Y,
    /// Along the vorticity.
    Z,
}

/// The least distance of pairs that is told apart, over the box's shortest edge.
const SHORTEST: f64 = 1e-6;

/// The most bins of a profile.
const MOST_BINS: usize = 1024;

impl Statistics {
    /// Samples of every frame, and defaults.
    pub const ALL: Self =
        Self { samples: Schedule::EVERY_TIME, from: 0.0, distance: None, axis: None, bins: None, diffusive_from: None };

    pub(super) fn check(&self, cell: &PeriodicBox) -> Result<(), ParameterError> {
        ParameterError::unless_finite("statistics.from", self.from)?;
        self.check_boundaries(cell)?;
        if let Some(distance) = self.distance {
            ParameterError::unless_positive("statistics.distance", distance)?;
            let message = |message| ParameterError::new("statistics.distance", message);
            Self::check_distance(distance, cell).map_err(message)?;
        }
        let lag = self.diffusive_from.map(|lag| ParameterError::unless_positive("statistics.diffusive_from", lag));
        lag.transpose().map(drop)
    }

    /// Pairs are of boxes that repeat along all axes, bins of those with a wall or one open axis.
    fn check_boundaries(&self, cell: &PeriodicBox) -> Result<(), ParameterError> {
        let is_periodic = cell.boundaries() == Boundaries::Periodic;
        if self.distance.is_some() && !is_periodic {
            let message = "is set, but pairs are told apart in a box that repeats along all axes alone; leave it out";
            return Err(ParameterError::new("statistics.distance", message));
        }
        match self.bins {
            Some(_) if is_periodic => {
                let message = "is set, but profiles in bins are of a box with walls or one open axis; leave it out";
                Err(ParameterError::new("statistics.bins", message))
            }
            Some(bins) if !(1..=MOST_BINS).contains(&bins) => {
                let message = format!("is {bins}; profiles need from 1 to {MOST_BINS} bins");
                Err(ParameterError::new("statistics.bins", message))
            }
            _ => Ok(()),
        }
    }

    /// Whether pairs in a box can be told apart up to a distance; if not, what is wrong with it.
    pub fn check_distance(distance: f64, cell: &PeriodicBox) -> Result<(), String> {
        let shortest = cell.edges().min_element();
        let (found, least, most) = (Number(distance), Number(SHORTEST * shortest), Number(shortest));
        if distance > shortest {
            return Err(format!("is {found}; pairs are told apart up to the box's shortest edge, {most}"));
        }
        if distance < SHORTEST * shortest {
            return Err(format!("is {found}; it needs at least {least:.4}, a millionth of the box's shortest edge"));
        }
        Ok(())
    }
}
