//! Outcome of the process of a member.

use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;

/// Outcome of a process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ProcessOutcome {
    /// The member is finished.
    Finished,
    /// The member stopped after this number of steps and can be continued.
    Stopped(u64),
    /// The process ended with this error.
    Failed(String),
}

/// Exit codes of a run that stopped and can be continued: by its time limit, Ctrl-C, and a request to terminate.
const STOPPED: [i32; 3] = [75, 130, 143];

impl ProcessOutcome {
    /// Outcome from the exit status, the steps that a run reports if it stops before its end, and the error in its log.
    pub fn of(status: ExitStatus, steps: Option<u64>, error: impl FnOnce() -> Option<String>) -> Self {
        match (status.code(), steps) {
            (Some(0), _) => Self::Finished,
            (Some(code), steps) if STOPPED.contains(&code) => Self::Stopped(steps.unwrap_or_default()),
            // The time limit was too short for a single step.
            (Some(_), Some(0)) => Self::Stopped(0),
            (Some(code), _) => Self::Failed(error().unwrap_or_else(|| format!("its process ended with code {code}"))),
            (None, _) => {
                let signal = status.signal().unwrap_or_default();
                let name = signal_hook::low_level::signal_name(signal).map_or(signal.to_string(), str::to_owned);
                Self::Failed(format!(
                    "its process was ended by signal {name}, as the system does where memory is short"
                ))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stopped_is_told_from_what_failed() {
        let of = |code: i32, steps| {
            ProcessOutcome::of(ExitStatus::from_raw(code << 8), steps, || Some("it broke".to_owned()))
        };
        assert_eq!(of(0, None), ProcessOutcome::Finished);
        assert_eq!([75, 130, 143].map(|code| of(code, Some(7))), [const { ProcessOutcome::Stopped(7) }; 3]);
        assert_eq!(of(1, Some(0)), ProcessOutcome::Stopped(0));
        assert_eq!(of(1, None), ProcessOutcome::Failed("it broke".to_owned()));
        let ProcessOutcome::Failed(killed) = ProcessOutcome::of(ExitStatus::from_raw(9), None, || None) else {
            panic!("it failed")
        };
        assert!(killed.contains("SIGKILL"), "{killed}");
    }
}
