//! Reasons for which a run stops before its end, and their exit codes.

use signal_hook::consts::{SIGINT, SIGTERM};
use std::fmt::{Display, Formatter};
use std::process::ExitCode;

/// Reason for which a run stops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// A signal.
    Signal(u8),
    /// The time limit is reached.
    TimeIsUp,
}

/// Exit code of a run that stopped and can be resumed: `EX_TEMPFAIL` of sysexits.h, "try again later".
const EXIT_RESUMABLE: u8 = 75;

/// Number of [`Stop::TimeIsUp`]; no signal has it.
const TIME_IS_UP: u8 = u8::MAX;

impl Stop {
    /// Number of the reason, above 0, by which ranks communicate it.
    pub fn number(self) -> u8 {
        match self {
            Self::Signal(signal) => signal,
            Self::TimeIsUp => TIME_IS_UP,
        }
    }

    /// Reason with this number; `None` for 0.
    pub fn of_number(number: u8) -> Option<Self> {
        match number {
            0 => None,
            TIME_IS_UP => Some(Self::TimeIsUp),
            signal => Some(Self::Signal(signal)),
        }
    }

    /// Exit code: 130 after Ctrl-C and 143 after SIGTERM, as shells expect; otherwise 75.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Signal(signal) if [SIGINT, SIGTERM].contains(&i32::from(signal)) => 128 + signal,
            _ => EXIT_RESUMABLE,
        }
    }
}

impl From<Stop> for ExitCode {
    fn from(stop: Stop) -> Self {
        Self::from(stop.exit_code())
    }
}

impl Display for Stop {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Signal(signal) => match signal_hook::low_level::signal_name(i32::from(*signal)) {
                Some(name) => f.write_str(name),
                None => write!(f, "signal {signal}"),
            },
            Self::TimeIsUp => f.write_str("the end of its time"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_codes_are_those_of_the_docs() {
        let codes = [(2, 130), (15, 143), (1, 75), (10, 75), (12, 75), (24, 75), (255, 75)];
        for (number, code) in codes {
            let stop = Stop::of_number(number).unwrap();
            assert_eq!((stop.number(), stop.exit_code()), (number, code), "{stop}");
        }
        assert_eq!(Stop::of_number(0), None);
        assert_eq!(Stop::Signal(10).to_string(), "SIGUSR1");
    }
}
