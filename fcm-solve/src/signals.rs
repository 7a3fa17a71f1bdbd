//! Ctrl-C and the requests of queueing systems to stop.

use domain::Comm;
use signal_hook::consts::{SIGINT, SIGTERM};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Remembers a signal until the step is over. A second Ctrl-C ends the program at once; a second request to terminate
/// does not, for launchers like to send several.
pub struct Signals {
    heard: Heard,
    comm: Comm,
}

/// What this process alone has heard, for any of its threads.
#[derive(Clone)]
pub struct Heard(Arc<AtomicUsize>);

/// The signal that a run ends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped by signal {0}")]
pub struct Stop(u8);

impl Signals {
    /// From now on.
    pub fn watch(comm: &Comm) -> std::io::Result<Self> {
        let received = Arc::new(AtomicUsize::new(0));
        let again = Arc::new(AtomicBool::new(false));
        signal_hook::flag::register_conditional_shutdown(SIGINT, 128 + SIGINT, again.clone())?;
        signal_hook::flag::register(SIGINT, again)?;
        for signal in [SIGINT, SIGTERM] {
            signal_hook::flag::register_usize(signal, received.clone(), signal as usize)?;
        }
        Ok(Self { heard: Heard(received), comm: comm.clone() })
    }

    /// The signal that any rank has received. Collective.
    pub fn received(&self) -> Option<Stop> {
        let mut signal = [self.heard.0.load(Ordering::Relaxed) as f64];
        self.comm.max(&mut signal);
        (signal[0] > 0.0).then_some(Stop(signal[0] as u8))
    }

    /// What this process hears.
    pub fn heard(&self) -> Heard {
        self.heard.clone()
    }
}

impl Heard {
    /// `Err` once a signal has been received.
    pub fn none(&self) -> Result<(), Stop> {
        match self.0.load(Ordering::Relaxed) {
            0 => Ok(()),
            signal => Err(Stop(signal as u8)),
        }
    }
}

impl Stop {
    /// What a shell expects of a program that a signal stopped.
    pub fn exit_code(self) -> ExitCode {
        ExitCode::from(128 + self.0)
    }
}
