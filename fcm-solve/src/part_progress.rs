//! Progress of work without time steps: the preparation of a start, or many runs.

use crate::streams;
use domain::Comm;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// Time between two lines where there is no terminal.
const PAUSE: Duration = Duration::from_secs(5);

/// Time before work is named in the log, and the same for work that usually takes about a second.
const SILENCE: Duration = Duration::from_secs(1);
const LONG_SILENCE: Duration = Duration::from_secs(4);

/// Progress as a fraction: a bar on a terminal, removed at the end; elsewhere a line now and then. Shown by the first
/// rank alone.
pub struct PartProgress {
    display: PartDisplay,
    what: &'static str,
}

enum PartDisplay {
    Bar(ProgressBar),
    Lines {
        said: Instant,
        naming: Option<Naming>,
    },
    /// No progress, but other messages.
    Quiet,
    Nothing,
}

impl PartProgress {
    /// Starts to show work that is described in a few words.
    pub fn start(comm: &Comm, what: &'static str) -> Self {
        Self::start_after(SILENCE, comm, what)
    }

    /// Like [`start`](Self::start), for work that usually ends soon: it is named only after some seconds.
    pub fn start_late(comm: &Comm, what: &'static str) -> Self {
        Self::start_after(LONG_SILENCE, comm, what)
    }

    fn start_after(silence: Duration, comm: &Comm, what: &'static str) -> Self {
        let display = match (comm.is_first(), std::io::stderr().is_terminal()) {
            (false, _) => PartDisplay::Nothing,
            (true, _) if streams::is_quiet() => PartDisplay::Quiet,
            (true, true) => PartDisplay::Bar(bar(what, silence)),
            (true, false) => PartDisplay::Lines { said: Instant::now(), naming: Naming::start(what, silence) },
        };
        Self { display, what }
    }

    /// Shows the fraction that is done, from 0 to 1.
    pub fn show(&mut self, part: f64) {
        let percent = (100.0 * part.clamp(0.0, 1.0)) as u64;
        if let PartDisplay::Lines { naming, .. } = &mut self.display {
            *naming = None;
        }
        match &mut self.display {
            PartDisplay::Bar(bar) => bar.set_position(percent),
            PartDisplay::Lines { said, .. } if said.elapsed() >= PAUSE => {
                streams::log(format_args!("{}: {percent}%", self.what));
                *said = Instant::now();
            }
            PartDisplay::Lines { .. } | PartDisplay::Quiet | PartDisplay::Nothing => {}
        }
    }

    /// Shows a message together with the progress.
    pub fn say(&self, message: &str) {
        match &self.display {
            PartDisplay::Bar(bar) => bar.suspend(|| streams::log(message)),
            PartDisplay::Lines { .. } | PartDisplay::Quiet => streams::log(message),
            PartDisplay::Nothing => {}
        }
    }
}

impl Drop for PartProgress {
    fn drop(&mut self) {
        if let PartDisplay::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

fn bar(what: &'static str, silence: Duration) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {percent}%, {msg}").expect("a good template");
    let bar = ProgressBar::new(100).with_style(style).with_message(what);
    bar.enable_steady_tick(silence);
    bar
}

/// Thread that names work whose progress is unknown, and the time that it has taken, at growing intervals.
struct Naming {
    /// Dropping the sender ends the thread.
    _end: Sender<()>,
}

impl Naming {
    /// Starts to name work; does nothing if no thread can be started.
    fn start(what: &'static str, silence: Duration) -> Option<Self> {
        let (end, ended) = channel::<()>();
        let (began, mut pause) = (Instant::now(), silence);
        let name = move || {
            while ended.recv_timeout(pause) == Err(RecvTimeoutError::Timeout) {
                streams::log(format_args!("{what}: {} s so far", began.elapsed().as_secs()));
                pause *= 3;
            }
        };
        std::thread::Builder::new().spawn(name).ok().map(|_| Self { _end: end })
    }
}
