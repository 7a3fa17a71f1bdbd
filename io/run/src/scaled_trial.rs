//! The time of a run on ranks that are not present, by a trial on one that is.

use crate::{Trial, time_in_words};
use domain::Number;
use scene::{Kind, Scene};
use simulation::Outline;
use suspension::{LATENCY, NODE, Ranks, Scaling, StepAlone};

/// A trial as it would be on other ranks.
#[derive(Debug, Clone, PartialEq)]
pub struct ScaledTrial {
    /// The time and the output on these ranks.
    pub trial: Trial,
    /// They, and their threads.
    pub ranks: Ranks,
    /// The part of the time of all ranks in which one alone would do the work.
    pub efficiency: f64,
    /// The largest number of ranks for which that is a half or more.
    pub worth: usize,
}

impl ScaledTrial {
    /// The trial of a scene by one rank with so many threads, on others; nothing of scenes of which it is not known how
    /// their steps scale. Threads are taken to share the work evenly, and what is done before the first step and to
    /// write is taken to stay.
    pub fn of(trial: &Trial, scene: &Scene, present: usize, ranks: Ranks) -> Option<Self> {
        let Kind::Suspension(of) = scene.kind() else { return None };
        let scaling = Scaling::of(&of.model)?;
        let seconds = trial.step * present as f64 / ranks.threads as f64;
        let alone = StepAlone { seconds, threads: ranks.threads };
        let step = scaling.seconds(alone, ranks.count);
        let run = (trial.run + trial.steps * (step - trial.step)).max(trial.start + step);
        Some(Self {
            trial: Trial { step, run, ..trial.clone() },
            ranks,
            efficiency: scaling.efficiency(alone, ranks.count),
            worth: scaling.ranks_worth(alone),
        })
    }

    /// Adds what it says to an outline.
    #[must_use]
    pub fn add_to(&self, outline: Outline) -> Outline {
        let Ranks { count, threads } = self.ranks;
        let [ranks, of] = [(count, "rank"), (threads, "thread")].map(|(n, one)| counted(n, one));
        let each = if count == 1 { "" } else { " each" };
        let outline = self.trial.add_time_to(outline, &format!(" on {ranks} of {of}{each}"));
        let outline = if count == 1 { outline } else { outline.line("", self.assumed()) };
        let worth = match self.worth {
            1 => "1 is worth it: of 2 less than half of the time would be work".to_owned(),
            worth => format!("up to {worth} are worth it: with more, less than half of their time is work"),
        };
        self.trial
            .add_output_to(outline.line("ranks", worth))
            .value("efficiency", self.efficiency)
            .value("ranks_worth", self.worth)
    }

    /// The machine and the network that are thought of.
    fn assumed(&self) -> String {
        format!(
            "{:.0}% of the time is work, with cores as fast as those here, {} a node with a port of {} GB/s, and {} a \
             message",
            100.0 * self.efficiency,
            NODE.cores,
            Number(NODE.port / 1e9),
            time_in_words(LATENCY)
        )
    }
}

/// So many of something.
fn counted(count: usize, one: &str) -> String {
    if count == 1 { format!("1 {one}") } else { format!("{count} {one}s") }
}
