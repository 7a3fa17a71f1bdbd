//! Hostile input for fcm-solve: valid files of every kind with edits, and the program's reaction to them.

mod bytes;
mod case_environment;
mod checkpoint;
mod hdf5_file;
mod hostile;
mod kinds;
mod misfit;
mod pool;
mod program;
mod report;
mod start;
mod surroundings;
mod table;
mod tree;
mod verdict;

use anyhow::Context;
use case_environment::CaseEnvironment;
use clap::Parser;
use kinds::{KINDS, kind_of};
use pool::InputPool;
use program::{ProcessLimits, Program};
use report::Report;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Tries the program with hostile input.
#[derive(Parser)]
struct FuzzArgs {
    /// The program
    #[arg(long, value_name = "FILE")]
    program: PathBuf,
    /// Number of cases
    #[arg(long, value_name = "N", default_value_t = 1000)]
    cases: u64,
    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Number of the only case to try
    #[arg(long, value_name = "K")]
    case: Option<u64>,
    /// Only this kind of input; may be given several times
    #[arg(long, value_name = "NAME")]
    kind: Vec<String>,
    /// Folder for the cases that the program did not survive
    #[arg(long, value_name = "DIR", default_value = "target/fuzz")]
    keep: PathBuf,
    /// Number of processes at a time
    #[arg(long, value_name = "N", default_value_t = 2)]
    jobs: usize,
    /// Gigabytes of address space of a process
    #[arg(long, value_name = "GB", default_value_t = 2)]
    memory: u64,
    /// Seconds until a run is asked to stop; also the processor time of any other command
    #[arg(long, value_name = "S", default_value_t = 10)]
    seconds: u64,
}

fn main() -> anyhow::Result<ExitCode> {
    let args = FuzzArgs::parse();
    let limits = ProcessLimits {
        memory: args.memory << 30,
        patience: Duration::from_secs(args.seconds),
        processor_seconds: args.seconds,
    };
    let path = args.program.canonicalize().with_context(|| format!("there is no {}", args.program.display()))?;
    let program = Program { path, limits };
    let place = tempfile::tempdir()?;
    let pool = InputPool::make(place.path(), &program)?;
    std::fs::create_dir_all(&args.keep)?;
    let report = Report::new(&args.keep);
    let numbers = args.case.map_or(0..args.cases, |case| case..case + 1);
    let next = AtomicU64::new(numbers.start);
    std::thread::scope(|scope| {
        for _ in 0..args.jobs.max(1) {
            scope.spawn(|| {
                while let Some(number) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|n| numbers.contains(n)) {
                    if args.kind.is_empty() || args.kind.iter().any(|kind| kind == KINDS[kind_of(number)].0) {
                        try_case(&report, &program, &pool, [args.seed, number]);
                    }
                }
            });
        }
    });
    print!("{report}");
    Ok(if report.all_survived() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn try_case(report: &Report, program: &Program, pool: &InputPool, [seed, number]: [u64; 2]) {
    let kind = kind_of(number);
    let folder = match tempfile::tempdir() {
        Ok(folder) => folder,
        Err(error) => return eprintln!("case {number}: no folder for it: {error}"),
    };
    let mut lab = CaseEnvironment::new(program, pool, folder.path(), [seed, number]);
    let result = KINDS[kind].2(&mut lab);
    report.add(kind, number, result, folder);
}
