//! Steps at which output was due and that a file lacks.

use simulation::Schedule;
use std::fmt::{Display, Formatter};
use std::ops::RangeInclusive;

/// Schedule of an output in a part of a run, including both ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Period {
    /// Steps.
    pub steps: RangeInclusive<u64>,
    /// Schedule in these steps.
    pub schedule: Schedule,
}

/// Missing steps, in ascending order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MissingSteps {
    runs: Vec<Progression>,
}

/// The steps `first, first + every, ..., last`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Progression {
    first: u64,
    last: u64,
    every: u64,
}

impl MissingSteps {
    /// The steps of a span that were due in some periods and are not in `there`, in ascending order.
    pub fn of(periods: &[Period], there: &[u64], span: &RangeInclusive<u64>) -> Self {
        let mut there = there.to_vec();
        there.sort_unstable();
        let mut runs = Vec::new();
        for Period { steps, schedule } in periods {
            let (first, last) = (*steps.start().max(span.start()), *steps.end().min(span.end()));
            let mut from = first;
            for &step in there.iter().filter(|step| (first..=last).contains(*step)) {
                runs.extend(step.checked_sub(1).and_then(|before| Progression::due(*schedule, from..=before)));
                from = step.saturating_add(1);
            }
            runs.extend(Progression::due(*schedule, from..=last));
        }
        Self { runs }
    }

    /// Number of missing steps.
    pub fn count(&self) -> u64 {
        self.runs.iter().fold(0, |count, run| count.saturating_add(run.count()))
    }

    /// Whether no step is missing.
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }
}

impl Progression {
    /// The steps of a range at which output is due, if there are any.
    fn due(schedule: Schedule, range: RangeInclusive<u64>) -> Option<Self> {
        let (from, until) = range.into_inner();
        let every = schedule.next_after(0).filter(|_| from <= until)?;
        let first = if schedule.is_due(from) { from } else { schedule.next_after(from)? };
        (first <= until).then(|| Self { first, last: until - until % every, every })
    }

    fn count(&self) -> u64 {
        (self.last - self.first) / self.every + 1
    }
}

/// Largest number of progressions that are listed.
const NAMED: usize = 6;

impl Display for MissingSteps {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(if self.count() == 1 { "step " } else { "steps " })?;
        for (place, run) in self.runs.iter().take(NAMED).enumerate() {
            write!(f, "{}{run}", if place == 0 { "" } else { ", " })?;
        }
        let more: u64 = self.runs.iter().skip(NAMED).map(Progression::count).sum();
        if more > 0 { write!(f, ", and {more} more") } else { Ok(()) }
    }
}

impl Display for Progression {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { first, last, every } = self;
        match (self.count(), every) {
            (1, _) => write!(f, "{first}"),
            (_, 1) => write!(f, "{first} to {last}"),
            (2, _) => write!(f, "{first}, {last}"),
            _ => write!(f, "{first} to {last} by {every}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn period(steps: RangeInclusive<u64>, every: u64) -> Period {
        Period { steps, schedule: Schedule::every(every) }
    }

    #[test]
    fn what_was_due_and_is_not_there_is_named() {
        let periods = [period(0..=20, 5), period(21..=24, 1), period(25..=100, 0), period(101..=130, 10)];
        let words = |there: &[u64], span| {
            let missing = MissingSteps::of(&periods, there, &span);
            (missing.count(), missing.to_string())
        };
        assert_eq!(words(&[], 0..=130), (12, "steps 0 to 20 by 5, 21 to 24, 110 to 130 by 10".to_owned()));
        assert_eq!(words(&[0, 10, 15, 20, 21, 110, 120], 0..=130), (5, "steps 5, 22 to 24, 130".to_owned()));
        assert_eq!(words(&[0, 20, 22, 21, 23], 0..=23), (3, "steps 5 to 15 by 5".to_owned()));
        assert_eq!(words(&[5], 0..=10), (2, "steps 0, 10".to_owned()));
        assert_eq!(words(&[5], 3..=10), (1, "step 10".to_owned()));
        assert!(MissingSteps::of(&periods, &[0, 5, 10], &(0..=14)).is_empty());
    }

    #[test]
    fn many_are_counted_and_few_named() {
        let odd: Vec<u64> = (0..40).filter(|step| step % 2 == 1).collect();
        let missing = MissingSteps::of(&[period(0..=40, 1)], &odd, &(0..=40));
        assert_eq!(missing.to_string(), "steps 0, 2, 4, 6, 8, 10, and 15 more");
        let all = MissingSteps::of(&[period(0..=u64::MAX, 1)], &[7], &(0..=u64::MAX));
        assert_eq!((all.count(), all.to_string()), (u64::MAX, format!("steps 0 to 6, 8 to {}", u64::MAX)));
        assert!(MissingSteps::of(&[period(7..=9, 1)], &[u64::MAX], &(0..=6)).is_empty());
    }
}
