//! The scene that a checkpoint belongs to.

use crate::checksum;
use crate::missing_steps::Period;
use scene::OutputSchedules;
use serde::{Deserialize, Serialize};
use simulation::Schedule;

/// The scene that a checkpoint belongs to, and the output schedules over the course of the run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneRecord {
    text: String,
    /// XXH3 checksum of the text (64 bits) as hexadecimal digits.
    digest: String,
    written: Vec<Intervals>,
}

/// Steps between frames, rows, fields and contact lists, from a step on; 0 means never.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Intervals {
    from: u64,
    every: [u64; 4],
}

/// An output with a schedule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputKind {
    /// Frames of the trajectory.
    Frames,
    /// Rows of the time series.
    Rows,
    /// Velocity fields.
    Fields,
    /// Lists of contacts.
    Contacts,
}

impl SceneRecord {
    /// Record of a run at its start.
    pub fn new(text: &str, output: &OutputSchedules) -> Self {
        let every = intervals(output);
        Self { text: text.to_owned(), digest: digest(text), written: vec![Intervals { from: 0, every }] }
    }

    /// Record of the same run with a scene that has changed after a step.
    #[must_use]
    pub fn changed(mut self, text: &str, output: &OutputSchedules, step: u64) -> Self {
        let every = intervals(output);
        self.written.retain(|intervals| intervals.from <= step);
        if self.written.last().is_none_or(|last| last.every != every) {
            self.written.push(Intervals { from: step + 1, every });
        }
        Self { text: text.to_owned(), digest: digest(text), ..self }
    }

    /// The scene as TOML.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether the digest matches the text.
    pub(super) fn is_whole(&self) -> bool {
        self.digest == digest(&self.text)
    }

    /// Schedules of an output up to a step.
    pub fn periods(&self, what: OutputKind, last: u64) -> Vec<Period> {
        let ends = self.written.iter().skip(1).map(|next| next.from.saturating_sub(1)).chain([last]);
        let period = |(intervals, end): (&Intervals, u64)| Period {
            steps: intervals.from..=end.min(last),
            schedule: Schedule::every(intervals.every[what as usize]),
        };
        self.written.iter().zip(ends).map(period).collect()
    }
}

fn intervals(output: &OutputSchedules) -> [u64; 4] {
    let every = |schedule: Schedule| schedule.next_after(0).unwrap_or(0);
    [output.trajectory, output.observables, output.fields, output.contacts].map(every)
}

/// Digest of the text of a scene.
fn digest(text: &str) -> String {
    format!("{:016x}", checksum::of(text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Scene;

    fn output(every: u64) -> OutputSchedules {
        let template = scene::Template::named("settling").unwrap();
        let overrides = [format!("output.trajectory_every={every}"), "output.observables_every=3".to_owned()];
        Scene::parse(template.text, "settling", &overrides).unwrap().kind().output().unwrap().clone()
    }

    #[test]
    fn periods_are_those_of_the_intervals() {
        let record = SceneRecord::new("a", &output(2)).changed("b", &output(2), 4).changed("c", &output(5), 10);
        let period = |steps, every| Period { steps, schedule: Schedule::every(every) };
        assert_eq!(record.periods(OutputKind::Frames, 20), [period(0..=10, 2), period(11..=20, 5)]);
        assert_eq!(record.periods(OutputKind::Rows, 20), [period(0..=10, 3), period(11..=20, 3)]);
        assert_eq!((record.text(), record.is_whole()), ("c", true));
        let back = record.clone().changed("d", &output(2), 7);
        assert_eq!(back.periods(OutputKind::Frames, 9), [period(0..=9, 2)], "what came after step 7 is gone");
        assert!(!SceneRecord { text: "e".to_owned(), ..record }.is_whole());
    }
}
