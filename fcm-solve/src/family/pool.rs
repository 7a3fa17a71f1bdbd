//! Pool of the processes of members that run side by side.

use super::FamilyTask;
use super::child::{Launch, Running};
use super::outcome::ProcessOutcome;
use crate::part_progress::PartProgress;
use crate::signals::Signals;
use crate::stop::Stop;
use domain::Number;
use run::FamilyFolder;
use scene::Member;
use std::collections::VecDeque;
use std::fmt::{Display, Formatter};
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Time between two polls of the processes.
const PAUSE: Duration = Duration::from_millis(3);
/// Shortest time between two writes of the table, in units of the time that a write takes.
const RARELY: u32 = 50;
/// Longest wait for a member that another program is working on, once nothing else is left to start.
const PATIENCE: Duration = Duration::from_secs(5);
/// Shortest remaining time with which a member is started.
const LEAST_TIME: Duration = Duration::from_secs(2);

/// A member whose run failed.
#[derive(Debug)]
pub struct MemberFailure {
    member: String,
    why: String,
    /// Log of its run.
    pub log: PathBuf,
}

impl Display for MemberFailure {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} failed: {}; its log is {}", self.member, self.why, self.log.display())
    }
}

/// Processes of members, on the cores of this process.
pub struct ProcessPool<'a> {
    work: &'a FamilyTask<'a>,
    folder: &'a FamilyFolder,
    signals: &'a Signals,
    progress: PartProgress,
    at_once: usize,
    running: Vec<Running<'a>>,
    written: Option<(Instant, Duration)>,
    failures: Vec<MemberFailure>,
    finished: u64,
    steps: u64,
}

impl<'a> ProcessPool<'a> {
    /// A pool of at most `at_once` processes at a time.
    pub fn new(
        work: &'a FamilyTask<'a>,
        folder: &'a FamilyFolder,
        at_once: usize,
        signals: &'a Signals,
        progress: PartProgress,
    ) -> Self {
        let (running, failures) = (Vec::new(), Vec::new());
        Self { work, folder, signals, progress, at_once, running, written: None, failures, finished: 0, steps: 0 }
    }

    /// Runs members, at most `at_once` at a time; `done` of `all` members are finished already.
    pub fn make(&mut self, members: &[&'a Member], done: usize, all: usize) -> anyhow::Result<()> {
        self.signals.run_begins(self.signals.command());
        let mut waiting: VecDeque<&Member> = members.iter().copied().collect();
        let mut is_asked = false;
        let mut idle_since = Instant::now();
        loop {
            if self.signals.received().is_some() {
                waiting.clear();
                if !std::mem::replace(&mut is_asked, true) {
                    self.running.iter().for_each(Running::ask_to_stop);
                }
            }
            if !self.running.is_empty() {
                idle_since = Instant::now();
            }
            self.start(&mut waiting, idle_since.elapsed() > PATIENCE)?;
            if self.running.is_empty() && waiting.is_empty() {
                return Ok(());
            }
            std::thread::sleep(PAUSE);
            self.collect(done, all)?;
        }
    }

    /// Starts members until `at_once` of them are running. A member that another program works on is skipped, unless
    /// `anyway`.
    fn start(&mut self, waiting: &mut VecDeque<&'a Member>, anyway: bool) -> anyhow::Result<()> {
        while self.running.len() < self.at_once {
            let is_free = |member: &&Member| anyway || !self.folder.is_running(member);
            let Some(place) = waiting.iter().position(is_free) else { return Ok(()) };
            let time = self.signals.time_left();
            if time.is_some_and(|time| time < LEAST_TIME) {
                self.signals.stop(Stop::TimeIsUp);
                return Ok(());
            }
            let slots = (self.at_once - self.running.len()).min(waiting.len());
            let used: usize = self.running.iter().map(|running| running.threads).sum();
            let threads = (rayon::current_num_threads().saturating_sub(used) / slots).max(1);
            let launch = Launch {
                family: self.work.family,
                folder: self.folder,
                accepted: self.work.accepted,
                time: time.map(|time| time.saturating_sub(LEAST_TIME / 2)),
            };
            if let Some(member) = waiting.remove(place) {
                self.running.push(Running::start(member, threads, &launch)?);
            }
        }
        Ok(())
    }

    /// Records the members that have ended, and writes the table now and then.
    fn collect(&mut self, done: usize, all: usize) -> anyhow::Result<()> {
        let mut place = 0;
        while place < self.running.len() {
            match self.running[place].outcome(self.folder)? {
                None => place += 1,
                Some(outcome) => {
                    let ended = self.running.swap_remove(place);
                    self.note(&ended, outcome, done, all);
                }
            }
        }
        let is_due = self.written.is_none_or(|(when, took)| when.elapsed() > took * RARELY);
        if self.finished > 0 && is_due {
            let began = Instant::now();
            self.folder.write_table(self.work.family)?;
            self.written = Some((Instant::now(), began.elapsed()));
        }
        Ok(())
    }

    fn note(&mut self, Running { member, began, .. }: &Running, outcome: ProcessOutcome, done: usize, all: usize) {
        match outcome {
            ProcessOutcome::Finished => {
                self.finished += 1;
                self.signals.stored_results().fetch_add(1, Ordering::SeqCst);
                let seconds = Number(began.elapsed().as_secs_f64());
                let number = done + self.finished as usize;
                self.progress.say(&format!("run {number} of {all}: {member}, {seconds:.2} s"));
                self.progress.show(number as f64 / all as f64);
            }
            ProcessOutcome::Stopped(steps) => {
                self.steps += steps;
                // Without a request it stopped by its time limit, which is that of the whole family.
                self.signals.stop(Stop::TimeIsUp);
            }
            ProcessOutcome::Failed(why) => {
                let failure = MemberFailure { member: member.to_string(), why, log: self.folder.log(member) };
                self.progress.say(&failure.to_string());
                self.failures.push(failure);
            }
        }
    }

    /// Members that failed.
    pub fn failures(&self) -> &[MemberFailure] {
        &self.failures
    }

    /// Number of steps taken by runs that stopped, plus the number of finished runs.
    pub fn steps_taken(&self) -> u64 {
        self.steps + self.finished
    }

    /// Whether the time limit was reached before anything new was computed.
    pub fn is_in_vain(&self, stop: Stop) -> bool {
        stop == Stop::TimeIsUp && self.steps_taken() == 0
    }
}
