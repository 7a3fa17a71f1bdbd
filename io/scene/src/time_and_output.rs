//! The sections `time` and `output` of scenes: the steps of a run, and its output.

use crate::checks::positive;
use crate::key_error::KeyError;
use domain::Number;
use simulation::Schedule;
use std::path::PathBuf;

/// Time step and number of steps.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Time {
    /// Time step.
    pub step: f64,
    /// Last step.
    pub steps: u64,
}

/// Output schedules and folder.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct OutputSchedules {
    /// Results folder; `None` if the caller chooses it.
    pub folder: Option<PathBuf>,
    /// Schedule of the trajectory's frames.
    pub trajectory: Schedule,
    /// Schedule of the time series' rows.
    pub observables: Schedule,
    /// Schedule of checkpoints.
    pub checkpoints: Schedule,
    /// Schedule of velocity fields.
    pub fields: Schedule,
    /// Schedule of contact forces.
    pub contacts: Schedule,
}

impl Time {
    /// A run that ends after a number of steps or a duration, one of which is given.
    pub(super) fn until(step: f64, steps: Option<u64>, duration: Option<f64>) -> Result<Self, KeyError> {
        positive("time.step", step)?;
        let steps = match (steps, duration) {
            (Some(steps), None) => return Self::of_steps(step, steps, "time.steps"),
            (None, Some(duration)) => steps_in(positive("time.duration", duration)?, step),
            (None, None) => return Err(KeyError::new("time", "has neither steps nor duration; set one of them")),
            (Some(_), Some(_)) => {
                return Err(KeyError::new("time", "has both steps and duration; leave one of them out"));
            }
        };
        Self::of_steps(step, steps, "time.duration")
    }

    /// A run of a number of steps that follows from a key.
    pub(super) fn of_steps(step: f64, steps: u64, key: &str) -> Result<Self, KeyError> {
        positive("time.step", step)?;
        let time = Self { step, steps };
        if steps > MOST_STEPS {
            let message = format!(
                "makes {:.3} steps up to the end of the run; there can be {MOST_STEPS}: take a longer time.step, or \
                 end earlier",
                Number(steps as f64)
            );
            return Err(KeyError::new(key, message));
        }
        if !time.end().is_finite() {
            let message = format!("is {}; {steps} steps of it are no finite time: take a shorter one", Number(step));
            return Err(KeyError::new("time.step", message));
        }
        Ok(time)
    }

    /// Time at the end of the last step.
    pub fn end(&self) -> f64 {
        self.steps as f64 * self.step
    }
}

/// Largest number of steps of a run: the times of all steps are distinct in double precision.
pub(super) const MOST_STEPS: u64 = 1 << 53;

impl OutputSchedules {
    /// Refuses more output than files can hold, for this number of steps and particles: the length of a file has 63
    /// bits, that of the largest array of a frame, the stresslets, 32.
    pub(super) fn check(&self, steps: u64, particles: f64) -> Result<(), KeyError> {
        let frame = 8.0 * 5.0 * particles;
        let is_due = |schedule: Schedule| schedule.count_until(steps) > 0;
        if is_due(self.trajectory) && frame > f64::from(u32::MAX) {
            let message = format!(
                "lets {particles:.1e} particles be written, but a frame of the trajectory holds {:.1e} at most; set \
                 it to 0, which is never",
                f64::from(u32::MAX) / 8.0 / 5.0
            );
            return Err(KeyError::new("output.trajectory_every", message));
        }
        // Positions, lattice steps, velocities, angular velocities and stresslets; and the
        // numbers of a row, and its page.
        let files = [
            ("output.trajectory_every", self.trajectory, "frames", 164.0 * particles + PAGE),
            ("output.observables_every", self.observables, "rows", PAGE),
        ];
        files.into_iter().try_for_each(|(key, schedule, things, bytes)| {
            let count = schedule.count_until(steps) as f64;
            let message = || {
                format!(
                    "makes {count:.1e} {things}, more than a file can hold: take fewer time.steps, or more of them \
                     from one to the next"
                )
            };
            if count * bytes < LONGEST { Ok(()) } else { Err(KeyError::new(key, message())) }
        })
    }
}

/// Approximate largest size of a row of a time series in a file.
const PAGE: f64 = 4096.0;
/// Largest number of bytes of a file.
const LONGEST: f64 = i64::MAX as f64;

/// Number of steps that cover a duration. A whole number of steps up to round-off gives that number.
pub(super) fn steps_in(duration: f64, step: f64) -> u64 {
    (duration / step * (1.0 - 1e-12) - 1e-9).ceil().max(0.0) as u64
}

/// Steps of one of `parts` parts of a run, at least one.
pub(super) fn share(steps: u64, parts: u64) -> u64 {
    steps.div_ceil(parts.max(1)).max(1)
}

/// Declares the section `output` of a kind of scene: the keys of all kinds, and those of its own.
macro_rules! output_section {
    ($(#[$about:meta])* $name:ident { $($own:tt)* }) => {
        $(#[$about])*
        #[derive(::serde::Deserialize, ::schemars::JsonSchema, Default)]
        #[serde(deny_unknown_fields, default)]
        pub(super) struct $name {
            /// Folder of the results.
            pub(super) folder: Option<::std::path::PathBuf>,
            /// Steps between frames of the trajectory; 0 for none.
            pub(super) trajectory_every: Option<u64>,
            /// Steps between rows of the time series; 0 for none.
            pub(super) observables_every: Option<u64>,
            /// Steps between checkpoints; 0 for none except at start and end.
            pub(super) checkpoint_every: Option<u64>,
            $($own)*
        }
    };
}
pub(crate) use output_section;

output_section! {
    /// The section `output` of scenes without a fluid.
    OutputSection {}
}

impl OutputSection {
    /// The checked section, with `rows` rows of the time series by default.
    pub(super) fn checked(self, steps: u64, rows: u64) -> OutputSchedules {
        OutputSchedules {
            folder: self.folder,
            trajectory: Schedule::every(self.trajectory_every.unwrap_or(share(steps, 100))),
            observables: Schedule::every(self.observables_every.unwrap_or(share(steps, rows))),
            checkpoints: Schedule::every(self.checkpoint_every.unwrap_or(share(steps, 10))),
            fields: Schedule::NEVER,
            contacts: Schedule::NEVER,
        }
    }
}
