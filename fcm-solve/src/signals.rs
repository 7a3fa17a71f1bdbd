//! Requests to stop: Ctrl-C, the signals of queueing systems, and the end of the time that a run has.

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

/// Time that the end of a program takes besides its last checkpoint.
const ENDING: Duration = Duration::from_secs(1);

/// When a run stops before its end, and who is told.
#[derive(clap::Args)]
pub struct StopArgs {
    /// Stop in time before so long has passed, as 23:50:00 or 1-12:00:00 [default: the end of the job, if Slurm says]
    #[arg(long, value_name = "TIME", value_parser = walltime::parse)]
    walltime: Option<Walltime>,
    /// Write into this file, if the run stops before its end, how many steps it has taken: for job scripts
    #[arg(long, value_name = "FILE")]
    steps_taken: Option<PathBuf>,
}

/// The message of a program whose time is up before it has written anything new.
const VAIN: &str = "error: the run's time is over before its first step, and nothing new is written: give it more \
    time (--walltime, or the job's limit)";

/// The handler of signals until the program ends. As long as there is nothing to save, a signal ends the program at
/// once; a run stops after its next checkpoint. A second Ctrl-C ends either at once; a second request to terminate does
/// not, since launchers often send several.
pub struct Signals {
    requests: Arc<Requests>,
    comm: Comm,
}

/// The requests that this process has received.
struct Requests {
    /// The number of the first [`Stop`]; 0 is none.
    stop: AtomicU8,
    /// Whether Ctrl-C was pressed before.
    pressed: AtomicBool,
    /// Whether there is a run, which looks here and saves its state.
    has_run: AtomicBool,
    /// Results that were stored and need not be computed again.
    results: Arc<AtomicU64>,
    /// When the run has to be over, and what it is known to take.
    end: Option<Instant>,
    pace: Mutex<Pace>,
    is_first: bool,
    /// The command that continues the run.
    command: Mutex<String>,
    /// The file that tells how many steps were taken.
    steps_taken: Option<PathBuf>,
}

/// The time that a run needs to stop.
#[derive(Default)]
struct Pace {
    looked: Option<Instant>,
    /// The longest time between two checks for requests: an evaluation, or writing output.
    pause: Duration,
    /// The longest time for a checkpoint.
    checkpoint: Duration,
}

impl Signals {
    /// Starts to handle signals, and the end of the run's time. `command` continues the run.
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
        let mut signals = signal_hook::iterator::Signals::new(heeded())?;
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

    /// Notes that there is now a run to save, which checks for requests, and the command that continues it.
    pub fn run_begins(&self, command: String) {
        self.go_on_with(command);
        self.requests.has_run.store(true, Ordering::SeqCst);
        self.requests.pace().looked = None;
    }

    /// The number of results that need not be computed again, for those that store them on any thread.
    pub fn stored_results(&self) -> Arc<AtomicU64> {
        self.requests.results.clone()
    }

    /// Tells how many steps were taken until the run stops, where that is asked for.
    pub fn tell_steps_taken(&self, steps: u64) {
        self.requests.tell_steps_taken(steps);
    }

    /// The request of any rank. Collective.
    pub fn received(&self) -> Option<Stop> {
        let mut number = [f64::from(self.requests.look())];
        self.comm.max(&mut number);
        let stop = Stop::of_number(number[0] as u8)?;
        self.requests.ask(stop);
        Some(stop)
    }

    /// The flag for computations: whether this rank is asked to stop.
    pub fn interrupt(&self) -> Interrupt {
        let requests = self.requests.clone();
        Interrupt::when(move || requests.look() != 0)
    }

    /// Notes how long a checkpoint took, so that there will be time for the last one.
    pub fn checkpoint_took(&self, time: Duration) {
        let mut pace = self.requests.pace();
        pace.checkpoint = pace.checkpoint.max(time);
    }

    /// Stops for a reason that was seen elsewhere.
    pub fn stop(&self, stop: Stop) {
        self.requests.ask(stop);
    }

    /// The time until the run has to be over, if it has an end.
    pub fn time_left(&self) -> Option<Duration> {
        self.requests.end.map(|end| end.saturating_duration_since(Instant::now()))
    }

    /// Sets the command that continues the run.
    pub fn go_on_with(&self, command: String) {
        *self.requests.command() = command;
    }

    /// The command that continues the run.
    pub fn command(&self) -> String {
        self.requests.command().clone()
    }
}

impl Requests {
    /// The number of the request, 0 for none. It is a request to stop, too, when only the time that a stop needs is
    /// left.
    fn look(&self) -> u8 {
        if let Some(end) = self.end {
            let now = Instant::now();
            if now + self.pace().look(now) >= end {
                self.ask(Stop::TimeIsUp);
            }
        }
        self.stop.load(Ordering::SeqCst)
    }

    /// The first request counts.
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

    /// Ends the program as it is; its files are whole at any time. It is an error if time is up and there is nothing new: such
    /// a job would be started again and again in vain.
    fn leave(&self, stop: Stop) -> ! {
        let results = self.results.load(Ordering::SeqCst);
        let is_vain = stop == Stop::TimeIsUp && results == 0;
        self.tell_steps_taken(results);
        if self.is_first {
            streams::log(if is_vain {
                VAIN.to_owned()
            } else {
                format!("stopped by {stop}; go on with: {}", self.command())
            });
            streams::finish_log();
        }
        signal_hook::low_level::exit(if is_vain { 1 } else { i32::from(stop.exit_code()) })
    }

    fn tell_steps_taken(&self, steps: u64) {
        let Some(path) = self.steps_taken.as_ref().filter(|_| self.is_first) else { return };
        if let Err(error) = io::replace_file(path, format!("{steps}\n").as_bytes()) {
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
    /// Notes the time of this check and returns how long a stop can take from now: until the next check, and two
    /// checkpoints, since a file system may be busy when many jobs end.
    fn look(&mut self, now: Instant) -> Duration {
        if let Some(before) = self.looked.replace(now) {
            self.pause = self.pause.max(now - before);
        }
        self.pause + 2 * self.checkpoint + ENDING
    }
}

/// The signals that are not ignored from the start, as `nohup` ignores SIGHUP, and shells SIGINT for background jobs.
fn heeded() -> Vec<i32> {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    let is_ignored = |signal: i32| mask.unwrap_or(0) >> (signal - 1) & 1 == 1;
    SIGNALS.into_iter().filter(|&signal| !is_ignored(signal)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run looks every 3 s and takes 2 s for a checkpoint.
    #[test]
    fn a_stop_is_given_the_time_that_it_takes() {
        let (start, mut pace) = (Instant::now(), Pace::default());
        assert_eq!(pace.look(start), ENDING);
        assert_eq!(pace.look(start + Duration::from_secs(3)), ENDING + Duration::from_secs(3));
        pace.checkpoint = Duration::from_secs(2);
        assert_eq!(pace.look(start + Duration::from_secs(4)), ENDING + Duration::from_secs(7));
    }
}
