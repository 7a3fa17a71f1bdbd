//! Schedules: steps at which output is due.

/// An interval in steps, counted from step 0; zero stands for never.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schedule(u64);

impl Schedule {
    /// Never.
    pub const NEVER: Self = Self(0);

    /// At every step.
    pub const EVERY_TIME: Self = Self(1);

    /// Due at the steps `0, steps, 2 steps, ...`; never if `steps` is zero.
    pub fn every(steps: u64) -> Self {
        Self(steps)
    }

    /// Whether it is due at this step.
    pub fn is_due(self, step: u64) -> bool {
        self.0 != 0 && step.is_multiple_of(self.0)
    }

    /// The first step after this one at which it is due, if there is one.
    pub fn next_after(self, step: u64) -> Option<u64> {
        step.checked_div(self.0).map(|times| (times + 1) * self.0)
    }

    /// Number of times it is due from step 0 to step `last`, both included.
    pub fn count_until(self, last: u64) -> u64 {
        last.checked_div(self.0).map_or(0, |times| times + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_due_is_counted() {
        for (every, last) in [(0, 10), (1, 0), (3, 10), (5, 10), (20, 10)] {
            let schedule = Schedule::every(every);
            let due = (0..=last).filter(|&step| schedule.is_due(step)).count();
            assert_eq!(schedule.count_until(last), due as u64);
            let next = (last + 1..=last + every).find(|&step| schedule.is_due(step));
            assert_eq!(schedule.next_after(last), next);
        }
    }
}
