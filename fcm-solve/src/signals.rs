//! Requests to stop: Ctrl-C, the signals of queueing systems, and the time limit of a run.

use crate::stop::Stop;
use crate::streams;
use crate::walltime::{self, Walltime};
use domain::{Comm, Interrupt};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The signals that stop a run.
const SIGNALS: [i32; 6] = [SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU];

/// Time reserved for ending the program, in addition to the last checkpoint.
const ENDING: Duration = Duration::from_secs(1);

/// Time limit of a run, and a file for the number of steps that it has taken.
#[derive(clap::Args)]
pub struct StopArgs {
    /// Stop before this time has passed, as 23:50:00 or 1-12:00:00 [default: the end of the job, if Slurm says]
    #[arg(long, value_name = "TIME", value_parser = walltime::parse)]
    walltime: Option<Walltime>,
    /// Write into this file the number of steps taken, if the run stops before its end: for job scripts
    #[arg(long, value_name = "FILE")]
    steps_taken: Option<PathBuf>,
}

/// Error of a program whose time limit is reached before it has written any new result.
const NOTHING_WRITTEN: &str = "error: the run's time is over before its first step, and nothing new is written: give \
    it more time (--walltime, or the job's limit)";

/// Handler of signals until the program ends. As long as there is nothing to save, a signal ends the program at once; a
/// run stops after its next checkpoint. A second Ctrl-C ends the program at once in either case; a second request to
/// terminate does not, since launchers often send several.
pub struct Signals {
    requests: Arc<Requests>,
    comm: Comm,
}

/// Requests to stop that this process has received.
struct Requests {
    /// Number of the first [`Stop`] requested; 0 for none.
    stop: AtomicU8,
    /// Whether Ctrl-C has been pressed already.
    pressed: AtomicBool,
    /// Whether a run is going on that checks for requests and saves its state.
    has_run: AtomicBool,
    /// Number of stored results, which need not be computed again.
    results: Arc<AtomicU64>,
    /// Instant by which the run has to be over, and the measured times that it needs to stop.
    end: Option<Instant>,
    pace: Mutex<Pace>,
    is_first: bool,
    /// Command line that continues the run.
    command: Mutex<String>,
    /// File for the number of steps taken.
    steps_taken: Option<PathBuf>,
}

/// The time that a run needs to stop.
#[derive(Default)]
struct Pace {
    looked: Option<Instant>,
    /// Longest time between two checks for requests: an evaluation, or writing output.
    pause: Duration,
    /// Longest time that a checkpoint took.
    checkpoint: Duration,
}

impl Signals {
    /// Starts to handle signals and the time limit of the run. `command` is the command line that continues the run.
    pub fn watch(comm: &Comm, command: String, stops: &StopArgs) -> std::io::Result<Self> {
        let end = walltime::end(stops.walltime);
        let requests = Arc::new(Requests {
            stop: AtomicU8::new(0),
            pressed: AtomicBool::new(false),
            has_run: AtomicBool::new(false),
            results: Arc::default(),
            end,
            pace: Mutex::default(),
            is_first: comm.is_first(),
            command: Mutex::new(command),
            steps_taken: stops.steps_taken.clone(),
        });
        let mut signals = signal_hook::iterator::Signals::new(handled_signals())?;
        let listener = requests.clone();
        let listen = move || signals.forever().for_each(|signal| listener.receive(Stop::Signal(signal as u8)));
        std::thread::Builder::new().name("signals".to_owned()).spawn(listen)?;
        if let Some(end) = end {
            let timer = requests.clone();
            let wait = move || {
                std::thread::sleep(end.saturating_duration_since(Instant::now() + ENDING));
                timer.receive(Stop::TimeIsUp);
            };
            std::thread::Builder::new().name("walltime".to_owned()).spawn(wait)?;
        }
        Ok(Self { requests, comm: comm.clone() })
    }

    /// Announces a run that checks for requests and saves its state, and the command line that continues it.
    pub fn run_begins(&self, command: String) {
        self.go_on_with(command);
        self.requests.has_run.store(true, Ordering::SeqCst);
        self.requests.pace().looked = None;
    }

    /// Counter of results that need not be computed again, to be incremented by whoever stores them, on any thread.
    pub fn stored_results(&self) -> Arc<AtomicU64> {
        self.requests.results.clone()
    }

    /// Writes the number of steps taken into the file asked for, if any, when the run stops.
    pub fn tell_steps_taken(&self, steps: u64) {
        self.requests.tell_steps_taken(steps);
    }

    /// A request to stop received on any rank. Collective.
    pub fn received(&self) -> Option<Stop> {
        let mut number = [f64::from(self.requests.poll())];
        self.comm.max(&mut number);
        let stop = Stop::of_number(number[0] as u8)?;
        self.requests.ask(stop);
        Some(stop)
    }

    /// Interrupt flag for computations: whether this rank is asked to stop.
    pub fn interrupt(&self) -> Interrupt {
        let requests = self.requests.clone();
        Interrupt::when(move || requests.poll() != 0)
    }

    /// Records the duration of a checkpoint, so that enough time is reserved for the last one.
    pub fn checkpoint_took(&self, time: Duration) {
        let mut pace = self.requests.pace();
        pace.checkpoint = pace.checkpoint.max(time);
    }

    /// Requests a stop for a reason detected elsewhere.
    pub fn stop(&self, stop: Stop) {
        self.requests.ask(stop);
    }

    /// Time until the run has to be over, if it has a time limit.
    pub fn time_left(&self) -> Option<Duration> {
        self.requests.end.map(|end| end.saturating_duration_since(Instant::now()))
    }

    /// Sets the command line that continues the run.
    pub fn go_on_with(&self, command: String) {
        *self.requests.command() = command;
    }

    /// Command line that continues the run.
    pub fn command(&self) -> String {
        self.requests.command().clone()
    }
}

impl Requests {
    /// Number of the request, 0 for none. The time limit is a request to stop as soon as the remaining time is no more
    /// than a stop takes.
    fn poll(&self) -> u8 {
        if let Some(end) = self.end {
            let now = Instant::now();
            if now + self.pace().poll(now) >= end {
                self.ask(Stop::TimeIsUp);
            }
        }
        self.stop.load(Ordering::SeqCst)
    }

    /// Records a request to stop; only the first one counts.
    fn ask(&self, stop: Stop) {
        let _ = self.stop.compare_exchange(0, stop.number(), Ordering::SeqCst, Ordering::SeqCst);
    }

    fn receive(&self, stop: Stop) {
        self.ask(stop);
        let is_second = stop == Stop::Signal(SIGINT as u8) && self.pressed.swap(true, Ordering::SeqCst);
        if is_second || !self.has_run.load(Ordering::SeqCst) {
            self.leave(stop);
        }
    }

    /// Ends the program at once; its files are complete at any time. It is an error if the time limit is reached and
    /// nothing new was written: such a job would be started again and again in vain.
    fn leave(&self, stop: Stop) -> ! {
        let results = self.results.load(Ordering::SeqCst);
        let is_vain = stop == Stop::TimeIsUp && results == 0;
        self.tell_steps_taken(results);
        if self.is_first {
            streams::log(if is_vain {
                NOTHING_WRITTEN.to_owned()
            } else {
                format!("stopped by {stop}; go on with: {}", self.command())
            });
            streams::finish_log();
        }
        signal_hook::low_level::exit(if is_vain { 1 } else { i32::from(stop.exit_code()) })
    }

    fn tell_steps_taken(&self, steps: u64) {
        let Some(path) = self.steps_taken.as_ref().filter(|_| self.is_first) else { return };
        if let Err(error) = files::replace_file(path, format!("{steps}\n").as_bytes()) {
            streams::log(format_args!("warning: {error}"));
        }
    }

    fn pace(&self) -> MutexGuard<'_, Pace> {
        self.pace.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn command(&self) -> MutexGuard<'_, String> {
        self.command.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Pace {
    /// Records the time of this check and returns the time that a stop can take from now: the time until the next
    /// check, and twice that of a checkpoint, since a file system may be busy when many jobs end.
    fn poll(&mut self, now: Instant) -> Duration {
        if let Some(before) = self.looked.replace(now) {
            self.pause = self.pause.max(now - before);
        }
        self.pause + 2 * self.checkpoint + ENDING
    }
}

/// Signals to handle: all but those ignored since the start of the process, as `nohup` ignores SIGHUP, and shells
/// SIGINT for background jobs.
fn handled_signals() -> Vec<i32> {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    let is_ignored = |signal: i32| mask.unwrap_or(0) >> (signal - 1) & 1 == 1;
    SIGNALS.into_iter().filter(|&signal| !is_ignored(signal)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The run checks for requests every 3 s, and a checkpoint takes 2 s.
    #[test]
    fn a_stop_is_given_the_time_that_it_takes() {
        let (start, mut pace) = (Instant::now(), Pace::default());
        assert_eq!(pace.poll(start), ENDING);
        assert_eq!(pace.poll(start + Duration::from_secs(3)), ENDING + Duration::from_secs(3));
        pace.checkpoint = Duration::from_secs(2);
        assert_eq!(pace.poll(start + Duration::from_secs(4)), ENDING + Duration::from_secs(7));
    }
}
