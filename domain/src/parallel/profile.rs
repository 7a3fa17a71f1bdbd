//! Measured stages, and the time that they would take on other numbers of threads.

use super::recorder::LoopEvent;
use std::panic::Location;

/// Measured parts of a computation.
#[derive(Debug, Clone, Default)]
pub struct ParallelProfile {
    stages: Vec<StageProfile>,
    pieces: Vec<SerialPiece>,
}

/// One part of a computation.
#[derive(Debug, Clone, PartialEq)]
pub struct StageProfile {
    /// Name of the part.
    pub name: &'static str,
    /// Seconds outside of parallel loops.
    pub serial: f64,
    /// Parallel loops by their places in the source.
    pub loops: Vec<LoopProfile>,
}

/// Parallel loop at one place of the source, summed over its runs.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopProfile {
    /// Place in the source.
    pub place: &'static Location<'static>,
    /// Number of runs.
    pub runs: u64,
    /// Seconds from begin to end.
    pub seconds: f64,
    /// Number of tasks.
    pub tasks: u64,
    /// Seconds in all tasks.
    pub work: f64,
    /// Seconds in the largest task of each run.
    pub largest: f64,
    /// Seconds in the mean task of each run.
    pub mean: f64,
    /// Bytes read and written, as far as they were counted.
    pub bytes: u64,
}

/// Time between two parallel loops of a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SerialPiece {
    /// Stage that contains it.
    pub stage: &'static str,
    between: [LoopEvent; 2],
    /// Seconds in all runs.
    pub seconds: f64,
}

impl SerialPiece {
    /// The place after which it begins, and the one before which it ends.
    pub fn between(&self) -> [String; 2] {
        self.between.map(|place| place.to_string())
    }
}

/// Machine for which times are estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Machine {
    /// Number of cores.
    pub cores: usize,
    /// Bytes a second from and to memory of one thread.
    pub bandwidth_of_one: f64,
    /// The same of all cores together.
    pub bandwidth: f64,
    /// Seconds by which a parallel loop is longer for each doubling of the threads.
    pub wake_up: f64,
}

impl Machine {
    /// Bytes a second of a number of threads; on more than the cores, of a machine with the same bandwidth a core.
    fn bandwidth_on(&self, threads: usize) -> f64 {
        let beyond = (threads as f64 / self.cores as f64).max(1.0);
        (self.bandwidth_of_one * threads as f64).min(self.bandwidth * beyond)
    }
}

impl LoopProfile {
    /// Seconds on a number of threads: its share of the work, but no less than the largest task or than the memory
    /// takes.
    fn seconds_on(&self, threads: usize, machine: &Machine) -> f64 {
        if threads == 1 {
            return self.seconds;
        }
        let wake_up = machine.wake_up * (threads as f64).log2() * self.runs as f64;
        let in_memory = self.bytes as f64 / machine.bandwidth_on(threads);
        (self.work / threads as f64).max(self.largest).max(in_memory) + wake_up
    }

    /// Estimated seconds on a number of threads beyond an even division of the work.
    pub fn excess_on(&self, threads: usize, machine: &Machine) -> f64 {
        self.seconds_on(threads, machine) - self.work / threads as f64
    }

    /// Largest task over the mean of its run, at least 1.
    pub fn imbalance(&self) -> f64 {
        if self.mean > 0.0 { self.largest / self.mean } else { 1.0 }
    }
}

impl StageProfile {
    /// Seconds within parallel loops.
    pub fn parallel(&self) -> f64 {
        self.loops.iter().map(|of| of.seconds).sum()
    }

    /// Estimated seconds on a number of threads.
    pub fn seconds_on(&self, threads: usize, machine: &Machine) -> f64 {
        self.serial + self.loops.iter().map(|of| of.seconds_on(threads, machine)).sum::<f64>()
    }
}

impl ParallelProfile {
    /// Stages in the order of their first appearance.
    pub fn stages(&self) -> &[StageProfile] {
        &self.stages
    }

    /// Pieces outside of parallel loops, the longest first.
    pub fn pieces(&self) -> Vec<SerialPiece> {
        let mut pieces = self.pieces.clone();
        pieces.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        pieces
    }

    /// Seconds of everything that was measured.
    pub fn seconds(&self) -> f64 {
        self.stages.iter().map(|stage| stage.serial + stage.parallel()).sum()
    }

    /// Seconds outside of parallel loops.
    pub fn serial(&self) -> f64 {
        self.stages.iter().map(|stage| stage.serial).sum()
    }

    /// Estimated seconds on a number of threads.
    pub fn seconds_on(&self, threads: usize, machine: &Machine) -> f64 {
        self.stages.iter().map(|stage| stage.seconds_on(threads, machine)).sum()
    }

    /// The lesser of the seconds of two profiles of the same computation, part by part: on a busy machine, what other
    /// programs add to one of them is left out.
    #[must_use]
    pub fn least(mut self, other: &Self) -> Self {
        for stage in &mut self.stages {
            let Some(again) = other.stages.iter().find(|again| again.name == stage.name) else { continue };
            stage.serial = stage.serial.min(again.serial);
            for of_loop in &mut stage.loops {
                let Some(again) = again.loops.iter().find(|again| again.place == of_loop.place) else { continue };
                of_loop.seconds = of_loop.seconds.min(again.seconds);
                of_loop.work = of_loop.work.min(again.work);
                if again.largest < of_loop.largest {
                    (of_loop.largest, of_loop.mean) = (again.largest, again.mean);
                }
            }
        }
        for piece in &mut self.pieces {
            let is_same = |again: &&SerialPiece| (again.stage, again.between) == (piece.stage, piece.between);
            let again = other.pieces.iter().find(is_same).map_or(piece.seconds, |again| again.seconds);
            piece.seconds = piece.seconds.min(again);
        }
        self
    }

    pub(super) fn add_serial(&mut self, stage: &'static str, between: [LoopEvent; 2], seconds: f64) {
        self.stage(stage).serial += seconds;
        let is_same = |piece: &&mut SerialPiece| piece.stage == stage && piece.between == between;
        match self.pieces.iter_mut().find(is_same) {
            Some(piece) => piece.seconds += seconds,
            None => self.pieces.push(SerialPiece { stage, between, seconds }),
        }
    }

    pub(super) fn of_loop(&mut self, stage: &'static str, place: &'static Location<'static>) -> &mut LoopProfile {
        let loops = &mut self.stage(stage).loops;
        let at = loops.iter().position(|of| of.place == place).unwrap_or_else(|| {
            let (seconds, work, largest, mean) = (0.0, 0.0, 0.0, 0.0);
            loops.push(LoopProfile { place, runs: 0, seconds, tasks: 0, work, largest, mean, bytes: 0 });
            loops.len() - 1
        });
        &mut loops[at]
    }

    fn stage(&mut self, name: &'static str) -> &mut StageProfile {
        let at = self.stages.iter().position(|stage| stage.name == name).unwrap_or_else(|| {
            self.stages.push(StageProfile { name, serial: 0.0, loops: Vec::new() });
            self.stages.len() - 1
        });
        &mut self.stages[at]
    }
}
