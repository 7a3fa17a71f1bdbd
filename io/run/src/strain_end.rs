//! Forecast from the first steps of a run of its end by a strain.

use domain::Number;
use simulation::{Outline, Simulation};

/// Forecast from the first steps of the strain that ends a run, if the rate is not given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StrainEnd {
    /// The strain is reached after this number of steps if the rate stays constant.
    After(f64),
    /// The strain is not reached: this is the fraction of it at the last step.
    Missed(f64),
    /// No strain has accumulated yet.
    Unknown,
}

impl StrainEnd {
    /// Forecast for a run of at most `last` steps, if a strain ends it.
    pub fn of(simulation: &dyn Simulation, last: u64) -> Option<Self> {
        Some(Self::by(simulation.progress()?, simulation.clock().step(), last))
    }

    /// Forecast from the fraction of the strain that the first steps have accumulated.
    fn by(part: f64, steps: u64, last: u64) -> Self {
        let all = steps as f64 / part;
        match part > 0.0 {
            false => Self::Unknown,
            true if all <= last as f64 => Self::After(all.ceil()),
            true => Self::Missed(last as f64 / all),
        }
    }

    /// Number of steps until the run ends, at most `most`.
    pub fn steps(self, most: f64) -> f64 {
        if let Self::After(steps) = self { steps } else { most }
    }

    /// Adds the forecast after the given number of steps to an outline.
    pub fn add_to(self, outline: Outline, tried: u64) -> Outline {
        let text = match self {
            Self::After(steps) => {
                format!("reached after about {steps} steps at the rate of the first {tried}, which may change")
            }
            Self::Missed(part) => format!(
                "{:.2}% of it reached at time.duration, at the rate of the first {tried} steps; a longer one lets it \
                 be reached",
                Number(100.0 * part)
            ),
            Self::Unknown => {
                format!(
                    "unknown when it is reached: the first {tried} steps have sheared nothing; the time is that of \
                     all steps"
                )
            }
        };
        let expected = if let Self::After(steps) = self { Some(steps) } else { None };
        outline.line("strain", text).value("expected_steps", expected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_counted_until_the_strain_or_the_last_one() {
        assert_eq!(StrainEnd::by(0.25, 10, 400), StrainEnd::After(40.0));
        assert_eq!(StrainEnd::by(1.0, 10, 400), StrainEnd::After(10.0));
        assert_eq!(StrainEnd::by(0.01, 10, 400), StrainEnd::Missed(0.4));
        assert_eq!(StrainEnd::by(0.0, 10, 400), StrainEnd::Unknown);
        let steps =
            [StrainEnd::After(40.0), StrainEnd::Missed(0.4), StrainEnd::Unknown].map(|end| end.steps(400.0) as u64);
        assert_eq!(steps, [40, 400, 400]);
    }
}
