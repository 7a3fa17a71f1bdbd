//! Record of loops and of what is between them, on the thread that starts the loops.

use super::iterator::Tasks;
use super::profile::ParallelProfile;
use std::cell::RefCell;
use std::panic::Location;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Number of measurements under way in this process.
static MEASUREMENTS: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Record of a thread that measures; absent within its loops, so that nothing in a task is counted twice.
    static RECORDER: RefCell<Option<Box<LoopRecorder>>> = const { RefCell::new(None) };
}

/// Name of what no stage contains.
const OUTSIDE: &str = "other";

/// Places between which a serial piece lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum LoopEvent {
    Begin(&'static str),
    Loop(&'static Location<'static>),
    End(&'static str),
}

impl std::fmt::Display for LoopEvent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Begin(stage) => write!(f, "start of {stage}"),
            Self::Loop(place) => write!(f, "{}:{}", place.file(), place.line()),
            Self::End(stage) => write!(f, "end of {stage}"),
        }
    }
}

/// Time since any fixed instant, on the calling thread.
pub type TaskClock = fn() -> Duration;

/// Time that passes, whatever the thread does.
pub fn wall_clock() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}

/// Seconds that a clock takes to be read.
fn seconds_of_reading(clock: TaskClock) -> f64 {
    const READINGS: u32 = 256;
    let start = clock();
    (1..READINGS).for_each(|_| _ = clock());
    clock().saturating_sub(start).as_secs_f64() / f64::from(READINGS)
}

struct LoopRecorder {
    clock: TaskClock,
    /// Seconds that the clock takes to be read.
    reading: f64,
    profile: ParallelProfile,
    stages: Vec<&'static str>,
    /// Last event, and its instant.
    after: LoopEvent,
    since: Duration,
}

impl LoopRecorder {
    /// Counts the time since the last event as serial.
    fn pass(&mut self, before: LoopEvent) {
        let now = (self.clock)();
        let stage = self.stages.last().copied().unwrap_or(OUTSIDE);
        self.profile.add_serial(stage, [self.after, before], now.saturating_sub(self.since).as_secs_f64());
        (self.after, self.since) = (before, now);
    }
}

fn is_measured() -> bool {
    MEASUREMENTS.load(Ordering::Relaxed) > 0
}

fn with_recorder(act: impl FnOnce(&mut LoopRecorder)) {
    RECORDER.with_borrow_mut(|recorder| recorder.as_deref_mut().map(act));
}

/// Records the loops and stages that this thread starts in `work`, as timed by a clock: on a busy machine, one of the
/// time that the thread had on a core. Times of tasks need a pool of one thread, since the tasks of several threads
/// share caches and memory.
pub fn measure<R>(clock: TaskClock, work: impl FnOnce() -> R) -> (R, ParallelProfile) {
    let reading = seconds_of_reading(clock);
    let (after, since) = (LoopEvent::Begin(OUTSIDE), clock());
    let recorder =
        LoopRecorder { clock, reading, profile: ParallelProfile::default(), stages: Vec::new(), after, since };
    RECORDER.with_borrow_mut(|kept| *kept = Some(Box::new(recorder)));
    MEASUREMENTS.fetch_add(1, Ordering::Relaxed);
    let result = work();
    MEASUREMENTS.fetch_sub(1, Ordering::Relaxed);
    with_recorder(|recorder| recorder.pass(LoopEvent::End(OUTSIDE)));
    let recorder = RECORDER.with_borrow_mut(Option::take);
    (result, recorder.map_or_else(ParallelProfile::default, |recorder| recorder.profile))
}

/// Part of a computation, until it is dropped. A stage within another one is not counted in the outer one.
#[must_use = "a stage ends when it is dropped"]
pub struct MeasuredStage {
    name: Option<&'static str>,
}

/// Begins a stage.
pub fn stage(name: &'static str) -> MeasuredStage {
    if !is_measured() {
        return MeasuredStage { name: None };
    }
    with_recorder(|recorder| {
        recorder.pass(LoopEvent::Begin(name));
        recorder.stages.push(name);
    });
    MeasuredStage { name: Some(name) }
}

impl MeasuredStage {
    /// Ends this stage and begins another.
    pub fn next(&mut self, name: &'static str) {
        if self.name.replace(name).is_none() {
            self.name = None;
            return;
        }
        with_recorder(|recorder| {
            recorder.pass(LoopEvent::Begin(name));
            if let Some(last) = recorder.stages.last_mut() {
                *last = name;
            }
        });
    }
}

impl Drop for MeasuredStage {
    fn drop(&mut self) {
        let Some(name) = self.name else { return };
        with_recorder(|recorder| {
            recorder.pass(LoopEvent::End(name));
            recorder.stages.pop();
        });
    }
}

/// A loop that is being recorded.
pub(super) struct Recording {
    recorder: Box<LoopRecorder>,
    place: &'static Location<'static>,
}

impl Recording {
    /// `None` unless this thread measures.
    pub fn begin(place: &'static Location<'static>) -> Option<Self> {
        if !is_measured() {
            return None;
        }
        let mut recorder = RECORDER.with_borrow_mut(Option::take)?;
        recorder.pass(LoopEvent::Loop(place));
        Some(Self { recorder, place })
    }

    pub fn clock(&self) -> TaskClock {
        self.recorder.clock
    }

    pub fn end(self, tasks: &Tasks, bytes: usize) {
        let Self { mut recorder, place } = self;
        let now = (recorder.clock)();
        let (count, work, largest) = tasks.sums();
        let reading = recorder.reading;
        let seconds = now.saturating_sub(recorder.since).as_secs_f64() - 2.0 * reading * count as f64;
        recorder.since = now;
        let stage = recorder.stages.last().copied().unwrap_or(OUTSIDE);
        let of_loop = recorder.profile.of_loop(stage, place);
        of_loop.runs += 1;
        of_loop.seconds += seconds.max(0.0);
        of_loop.tasks += count;
        let work = (work - reading * count as f64).max(0.0);
        let mean = work / count.max(1) as f64;
        of_loop.work += work;
        of_loop.mean += mean;
        of_loop.largest += (largest - reading).max(mean);
        of_loop.bytes += bytes as u64;
        RECORDER.with_borrow_mut(|kept| *kept = Some(recorder));
    }
}

/// Rows that a parallel sort gives to one thread.
const SORTED_TOGETHER: usize = 2000;

/// A parallel sort of `rows` rows, recorded as a loop of equal tasks.
#[track_caller]
pub fn sort(rows: usize, work: impl FnOnce()) {
    let Some(recording) = Recording::begin(Location::caller()) else { return work() };
    let (clock, tasks) = (recording.clock(), Tasks::timed_by(recording.clock()));
    let start = clock();
    work();
    tasks.add(rows.div_ceil(SORTED_TOGETHER).max(1) as u64, clock().saturating_sub(start).as_nanos() as u64);
    recording.end(&tasks, 0);
}

/// Threads among which loops that have one part a thread divide their work while one thread measures them.
const IMAGINED: usize = 16;

/// Number of parts of a loop that has one for each thread: results are the same for any number.
pub fn parts() -> usize {
    let threads = rayon::current_num_threads();
    let is_imagined = threads == 1 && is_measured() && RECORDER.with_borrow(Option::is_some);
    if is_imagined { IMAGINED } else { threads }
}
