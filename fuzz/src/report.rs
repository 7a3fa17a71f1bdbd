//! Results of the cases.

use crate::case_environment::Fault;
use crate::kinds::KINDS;
use crate::verdict::ProcessEnd;
use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};
use tempfile::TempDir;

#[derive(Debug, Default, Clone, Copy)]
struct Count {
    answered: u64,
    refused: u64,
    stopped: u64,
    faults: u64,
}

impl Count {
    fn tried(&self) -> u64 {
        self.answered + self.refused + self.stopped + self.faults
    }

    fn plus(self, other: Self) -> Self {
        Self {
            answered: self.answered + other.answered,
            refused: self.refused + other.refused,
            stopped: self.stopped + other.stopped,
            faults: self.faults + other.faults,
        }
    }
}

/// Counts for each kind of input.
pub struct Report {
    counts: Mutex<[Count; KINDS.len()]>,
    keep: PathBuf,
}

impl Report {
    /// Empty counts. Folders of faults are moved to `keep`.
    pub fn new(keep: &Path) -> Self {
        Self { counts: Mutex::new([Count::default(); KINDS.len()]), keep: keep.to_owned() }
    }

    fn counts(&self) -> MutexGuard<'_, [Count; KINDS.len()]> {
        self.counts.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Counts a case; reports a fault, and keeps its folder.
    pub fn add(&self, kind: usize, number: u64, result: Result<ProcessEnd, Fault>, folder: TempDir) {
        let mut counts = self.counts();
        let count = &mut counts[kind];
        match result {
            Ok(ProcessEnd::Answered) => count.answered += 1,
            Ok(ProcessEnd::Refused) => count.refused += 1,
            Ok(ProcessEnd::Stopped) => count.stopped += 1,
            Err(fault) => {
                count.faults += 1;
                self.tell(kind, number, &fault, folder);
            }
        }
        let tried: u64 = counts.iter().map(Count::tried).sum();
        if tried.is_multiple_of(500) {
            eprintln!("{tried} cases tried");
        }
    }

    fn tell(&self, kind: usize, number: u64, fault: &Fault, folder: TempDir) {
        let kept = self.keep.join(format!("case-{number}"));
        let _ = std::fs::remove_dir_all(&kept);
        let from = folder.keep();
        let moved = std::process::Command::new("mv").arg(&from).arg(&kept).status().is_ok_and(|s| s.success());
        let words: Vec<String> = fault.command.iter().map(|word| word.to_string_lossy().into_owned()).collect();
        println!("case {number} ({}): {}", KINDS[kind].0, fault.what);
        println!("  fcm-solve {}", words.join(" "));
        fault
            .stderr
            .lines()
            .rev()
            .take(3)
            .for_each(|line| println!("  | {}", &line.chars().take(300).collect::<String>()));
        println!("  in {}", if moved { kept.display() } else { from.display() });
    }

    /// Whether there was no fault.
    pub fn all_survived(&self) -> bool {
        self.counts().iter().all(|count| count.faults == 0)
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let counts = *self.counts();
        let mut line = |name: &str, count: &Count| {
            let Count { answered, refused, stopped, faults } = count;
            let tried = count.tried();
            writeln!(f, "{name:<40} {tried:>6} {:>8} {answered:>8} {refused:>7} {stopped:>7}", tried - faults)
        };
        counts
            .iter()
            .zip(KINDS)
            .filter(|(count, _)| count.tried() > 0)
            .try_for_each(|(count, (name, ..))| line(name, count))?;
        line("all", &counts.iter().fold(Count::default(), |sum, count| sum.plus(*count)))
    }
}
