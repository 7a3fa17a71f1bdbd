//! The section `answers` of scenes: the times that means are taken of.

use crate::key_error::KeyError;
use crate::time_and_output::Time;
use domain::Number;
use schemars::JsonSchema;
use serde::Deserialize;

/// The section, as serde finds it.
#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(deny_unknown_fields)]
pub(super) struct AnswersSection {
    /// Time from which means are taken; by default the transient is left out that is found.
    from: f64,
}

impl AnswersSection {
    /// The time from which means are taken, in a run that lasts longer than that; none without the section.
    pub(super) fn start(raw: Option<Self>, time: &Time) -> Result<Option<f64>, KeyError> {
        let Some(Self { from }) = raw else { return Ok(None) };
        let end = time.end();
        if from >= 0.0 && from < end {
            return Ok(Some(from));
        }
        let message = format!(
            "is {:.6}; means need a time from 0 on and before the end of the run, which is {:.6}: take an earlier \
             one, or a longer run",
            Number(from),
            Number(end)
        );
        Err(KeyError::new("answers.from", message))
    }
}
