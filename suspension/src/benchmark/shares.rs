//! Measured shares of stages inside and outside of parallel loops, as lines of output.

use domain::parallel::{LoopProfile, Machine, ParallelProfile, StageProfile};
use serde::Serialize;

/// Numbers of threads for which times are estimated.
const THREADS: [usize; 7] = [2, 4, 8, 16, 32, 64, 128];

/// Number of serial pieces that are listed.
const PIECES: usize = 12;

/// Number of loops that are listed, by what so many threads lose in them.
const LOOPS: usize = 24;
const AMONG: usize = 16;

/// Stages of a computation, with estimates for more threads.
#[derive(Debug, Clone, Serialize)]
pub struct Shares {
    seconds: f64,
    serial_share: f64,
    stages: Vec<StageShare>,
    largest_serial: Vec<SerialPart>,
    uneven_loops: Vec<UnevenLoop>,
    estimates: Vec<ThreadEstimate>,
}

/// One stage, on one thread.
#[derive(Debug, Clone, Serialize)]
struct StageShare {
    stage: &'static str,
    seconds: f64,
    parallel: f64,
    serial: f64,
    /// Seconds outside of parallel loops over those of everything.
    serial_share: f64,
    loops: f64,
    tasks_per_loop: f64,
    largest_over_mean: f64,
    bytes: f64,
}

/// A part of a stage outside of parallel loops.
#[derive(Debug, Clone, Serialize)]
struct SerialPart {
    stage: &'static str,
    after: String,
    before: String,
    seconds: f64,
}

/// A parallel loop, with the seconds that 16 threads lose in it against an even division of its work.
#[derive(Debug, Clone, Serialize)]
struct UnevenLoop {
    stage: &'static str,
    place: String,
    loops: f64,
    tasks_per_loop: f64,
    seconds: f64,
    excess: f64,
}

/// Time that a number of threads would take.
#[derive(Debug, Clone, Serialize)]
struct ThreadEstimate {
    threads: usize,
    seconds: f64,
    speedup: f64,
}

impl Shares {
    /// Shares of a computation that was done `times` times.
    pub fn of(profile: &ParallelProfile, times: f64, machine: &Machine) -> Self {
        let seconds = profile.seconds();
        let share = |stage: &StageProfile| {
            let parallel = stage.parallel();
            let of_loops =
                |of: fn(&LoopProfile) -> f64| stage.loops.iter().map(of).fold(0.0, |sum, of_one| sum + of_one);
            let (runs, tasks, work) = (of_loops(|l| l.runs as f64), of_loops(|l| l.tasks as f64), of_loops(|l| l.work));
            let uneven = of_loops(|l| l.imbalance() * l.work);
            StageShare {
                stage: stage.name,
                seconds: (stage.serial + parallel) / times,
                parallel: parallel / times,
                serial: stage.serial / times,
                serial_share: stage.serial / seconds,
                loops: runs / times,
                tasks_per_loop: if runs > 0.0 { tasks / runs } else { 0.0 },
                largest_over_mean: if work > 0.0 { uneven / work } else { 1.0 },
                bytes: of_loops(|l| l.bytes as f64) / times,
            }
        };
        let piece = |piece: domain::parallel::SerialPiece| {
            let [after, before] = piece.between();
            SerialPart { stage: piece.stage, after, before, seconds: piece.seconds / times }
        };
        let uneven = |(stage, of): (&'static str, &LoopProfile)| UnevenLoop {
            stage,
            place: format!("{}:{}", of.place.file(), of.place.line()),
            loops: of.runs as f64 / times,
            tasks_per_loop: of.tasks as f64 / of.runs as f64,
            seconds: of.seconds / times,
            excess: of.excess_on(AMONG, machine) / times,
        };
        let loops = profile.stages().iter().flat_map(|stage| stage.loops.iter().map(|of| (stage.name, of)));
        let mut uneven_loops: Vec<UnevenLoop> = loops.map(uneven).collect();
        uneven_loops.sort_by(|a, b| b.excess.total_cmp(&a.excess));
        uneven_loops.truncate(LOOPS);
        let estimate = |threads| {
            let estimated = profile.seconds_on(threads, machine);
            ThreadEstimate { threads, seconds: estimated / times, speedup: seconds / estimated }
        };
        Self {
            seconds: seconds / times,
            serial_share: profile.serial() / seconds,
            stages: profile.stages().iter().map(share).collect(),
            largest_serial: profile.pieces().into_iter().take(PIECES).map(piece).collect(),
            uneven_loops,
            estimates: THREADS.map(estimate).into(),
        }
    }
}
