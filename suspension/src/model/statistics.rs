//! Statistics that are accumulated during a run.

use domain::{Boundaries, Number, ParameterError, PeriodicBox};
use simulation::Schedule;

/// Statistics that are accumulated during a run, and the times of their samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatisticsParameters {
    /// Times of the samples.
    pub samples: Schedule,
    /// Time of the first sample.
    pub from: f64,
    /// Largest distance of the pair distribution; by default 8 times the largest radius.
    pub distance: Option<f64>,
    /// Axis of concentration and segregation; by default that of the forces or of the gradient.
    pub axis: Option<Axis>,
    /// Number of bins across a channel; by default four per smallest radius.
    pub bins: Option<usize>,
    /// Time lag from which motion counts as diffusive; by default a quarter of the sampled time.
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

/// Shortest distance of the pair distribution, over the shortest edge of the box.
const SHORTEST: f64 = 1e-6;

/// Largest number of bins of a profile.
const MOST_BINS: usize = 1024;

impl StatisticsParameters {
    /// A sample at every frame, and defaults.
    pub const ALL: Self =
        Self { samples: Schedule::EVERY_TIME, from: 0.0, distance: None, axis: None, bins: None, diffusive_from: None };

    pub(super) fn check(&self, cell: &PeriodicBox) -> Result<(), ParameterError> {
        ParameterError::require_finite("statistics.from", self.from)?;
        self.check_boundaries(cell)?;
        if let Some(distance) = self.distance {
            ParameterError::require_positive("statistics.distance", distance)?;
            let message = |message| ParameterError::new("statistics.distance", message);
            Self::check_distance(distance, cell).map_err(message)?;
        }
        let lag = self.diffusive_from.map(|lag| ParameterError::require_positive("statistics.diffusive_from", lag));
        lag.transpose().map(drop)
    }

    /// The pair distribution needs a fully periodic box; bins need a wall or one open axis.
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

    /// A warning if no sample is due in a run of `steps` steps.
    pub(crate) fn caution(&self, time_step: f64, steps: u64) -> Option<String> {
        if self.samples_until(time_step, steps) > 0 {
            return None;
        }
        let (from, end) = (Number(self.from), Number(steps as f64 * time_step));
        Some(match self.samples.next_after(0) {
            None => "statistics.every = 0 takes no sample, so that there will be no statistics; set it to 1 or more, \
                or leave out [statistics]"
                .to_owned(),
            Some(every) => format!(
                "[statistics] take no sample: the run ends at time {end:.6}, after step {steps}, before the first of \
                 them is due, by statistics.from = {from:.6} and statistics.every = {every}; there will be no \
                 statistics unless the run goes on for longer"
            ),
        })
    }

    /// Number of samples due from step 0 to step `steps`, at times not before `from`.
    fn samples_until(&self, time_step: f64, steps: u64) -> u64 {
        let first = (self.from / time_step).ceil().max(0.0);
        // Rounding: `step * time_step` may differ in the last bit from the quotient's inverse.
        let first = if (first - 1.0) * time_step >= self.from { first - 1.0 } else { first };
        let first = if first * time_step < self.from { first + 1.0 } else { first }.max(0.0);
        if first > steps as f64 {
            return 0;
        }
        let before = (first as u64).checked_sub(1).map_or(0, |step| self.samples.count_until(step));
        self.samples.count_until(steps) - before
    }

    /// Whether the pair distribution can extend to a distance in a box; if not, the error message.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_those_that_are_due() {
        for (from, every, step, steps) in [
            (0.0, 1, 0.01, 8),
            (0.03, 1, 0.01, 8),
            (0.3, 3, 0.1, 20),
            (-1.0, 4, 0.1, 9),
            (0.7, 1, 0.1, 7),
            (0.8, 1, 0.1, 7),
        ] {
            let wanted = StatisticsParameters { samples: Schedule::every(every), from, ..StatisticsParameters::ALL };
            let is_taken = |k: &u64| k.is_multiple_of(every) && *k as f64 * step >= from;
            assert_eq!(
                wanted.samples_until(step, steps),
                (0..=steps).filter(is_taken).count() as u64,
                "{from} {every}"
            );
        }
    }

    #[test]
    fn statistics_without_samples_are_warned_of_with_both_times() {
        let said = |from, every| {
            StatisticsParameters { samples: Schedule::every(every), from, ..StatisticsParameters::ALL }
                .caution(0.01, 8)
                .unwrap_or_default()
        };
        assert!(said(1e6, 1).contains("time 0.08") && said(1e6, 1).contains("statistics.from = 1"), "{}", said(1e6, 1));
        assert!(said(0.01, 9).contains("statistics.every = 9"));
        assert!(said(0.0, 0).contains("statistics.every = 0 takes no sample"));
        assert_eq!([said(0.0, 9), said(0.08, 1), said(-5.0, 8)], ["", "", ""]);
    }
}
