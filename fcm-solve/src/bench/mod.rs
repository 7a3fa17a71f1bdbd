//! `fcm-solve bench`: run time of one mobility against its error.

mod shares;

use crate::number::{fraction, ratio, tolerance};
use crate::streams;
use clap::ValueEnum;
use domain::Comm;
use fcm::{ComputeDevice, Costs, Fixed, Method};
use serde::Serialize;
use std::path::PathBuf;
use suspension::benchmark::{BenchmarkCase, BenchmarkKind, CostMeasurement, Spheres, Task};

/// Cases of a benchmark: every combination of the lists, one JSON line each.
#[derive(clap::Args)]
#[command(after_help = LINE)]
pub struct BenchArgs {
    /// Numbers of spheres
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "3200",
        value_parser = clap::value_parser!(u32).range(1..),
        allow_hyphen_values = true
    )]
    particles: Vec<u32>,
    /// Volume fractions of the spheres
    #[arg(long, value_delimiter = ',', default_value = "0.12", value_parser = fraction, allow_hyphen_values = true)]
    volume_fraction: Vec<f64>,
    /// Radius of every second sphere; the others have the radius 1
    #[arg(long, value_delimiter = ',', default_value = "1", value_parser = ratio, allow_hyphen_values = true)]
    size_ratio: Vec<f64>,
    /// Relative errors allowed
    #[arg(long, value_delimiter = ',', default_value = "1e-3", value_parser = tolerance, allow_hyphen_values = true)]
    tolerance: Vec<f64>,
    /// Evaluation method of the envelopes
    #[arg(long, value_enum, default_value_t = Choice::Auto)]
    method: Choice,
    /// Device that evaluates the far field
    #[arg(long, value_enum, default_value_t = DeviceChoice::Cpu)]
    device: DeviceChoice,
    /// Grid points along each edge [default: as many as the tolerance needs]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    grid: Option<usize>,
    /// Forces alone: no torques, no stresslets
    #[arg(long)]
    monopoles: bool,
    /// Stresslets alone, and the rates of strain they cause, as in an iteration for rigid spheres
    #[arg(long, conflicts_with = "monopoles")]
    stresslets: bool,
    /// Evaluations, each at new positions, after one that is not counted
    #[arg(
        long,
        value_name = "N",
        default_value_t = 5,
        value_parser = clap::value_parser!(u32).range(1..),
        allow_hyphen_values = true
    )]
    repeats: u32,
    /// Do not measure the error by a second, much tighter evaluation
    #[arg(long)]
    no_error: bool,
    #[command(flatten)]
    stages: StageOptions,
}

/// Measurements of stages in place of times and errors.
#[derive(clap::Args)]
struct StageOptions {
    /// Print the time of each stage inside and outside of parallel loops instead, best with --threads 1
    #[arg(long)]
    serial: bool,
    /// The same for a step of a scene: lists, far field, near pairs, forces, observables and the start
    #[arg(long, value_name = "SCENE")]
    step: Option<PathBuf>,
}

const LINE: &str = "\
A line has particles, volume_fraction, size_ratio, tolerance, method, device, precision, grid, support, ranks,
threads, bytes_sent, messages_sent, seconds and error. Bytes and messages are what a rank sends to others for
one mobility, the most of all ranks; ranks on one machine read transposed rows from each other's memory
without messages. Seconds are medians over the repeats: spread, fft, solve, interpolate,
near, exchange and total, for one mobility F, T, S -> V, Omega, E at new positions. The Stokes solve is
made within the transform, so its time is part of fft and solve is 0. The error is the largest relative
2-norm of velocities, angular velocities and rates of strain against an evaluation on the host with a
tolerance 100 times smaller. On a card, fft includes the Stokes solve between the transforms, and exchange
is the time of copies between host and card.

With --serial a line has, for an evaluation that rebuilds neighbour lists (with_lists) and for one that does
not (repeated), the seconds on one thread and their share outside of parallel loops (serial_share), the
same by stage with the number of loops, tasks per loop, the largest task over the mean and bytes moved
as far as they are counted, the longest pieces outside of loops by the loops before and after them, and
estimates for 2 to 128 threads from these, with the measured bandwidth of memory. With --step SCENE the
same for the start, a step and the observables of a scene. Loops and their tasks are timed on the first rank.";

/// Evaluation method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Choice {
    /// The faster one
    Auto,
    /// Every envelope on the grid
    Direct,
    /// One common Gaussian on the grid, pairs for the rest
    Split,
    /// A matrix of exact sums over all pairs
    Dense,
}

/// Device of the far field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DeviceChoice {
    /// The processors of the host
    Cpu,
    /// A graphics card
    Gpu,
}

/// One line of the output.
#[derive(Serialize)]
struct BenchLine {
    #[serde(flatten)]
    case: BenchmarkCase,
    #[serde(flatten)]
    measured: CostMeasurement,
}

/// Runs all cases. Collective.
pub fn run(args: &BenchArgs, comm: &Comm) -> anyhow::Result<()> {
    if let Some(scene) = &args.stages.step {
        return shares::measure_steps(scene, args.repeats, comm);
    }
    let costs = run::kept_costs(args.device(), comm)?;
    for case in args.cases() {
        let spheres = Spheres::random(&case, comm)?;
        for &tolerance in &args.tolerance {
            if args.stages.serial {
                let stages = args.task(tolerance, costs).stages(&spheres, shares::thread_time, comm)?;
                shares::print_evaluations(case, tolerance, &stages, comm)?;
                continue;
            }
            let measured = args.task(tolerance, costs).measure(&spheres, comm)?;
            streams::print(comm, &(serde_json::to_string(&BenchLine { case, measured })? + "\n"))?;
        }
    }
    Ok(())
}

impl BenchArgs {
    fn cases(&self) -> Vec<BenchmarkCase> {
        let mut cases = Vec::new();
        for &particles in &self.particles {
            for &volume_fraction in &self.volume_fraction {
                for &size_ratio in &self.size_ratio {
                    cases.push(BenchmarkCase { particles: particles as usize, volume_fraction, size_ratio });
                }
            }
        }
        cases
    }

    fn device(&self) -> ComputeDevice {
        match self.device {
            DeviceChoice::Cpu => ComputeDevice::Cpu,
            DeviceChoice::Gpu => ComputeDevice::Gpu,
        }
    }

    fn task(&self, tolerance: f64, costs: Costs) -> Task {
        let method = match self.method {
            Choice::Auto => None,
            Choice::Direct => Some(Method::Direct),
            Choice::Split => Some(Method::Split),
            Choice::Dense => Some(Method::Dense),
        };
        let device = self.device();
        Task {
            tolerance,
            kind: match (self.monopoles, self.stresslets) {
                (true, _) => BenchmarkKind::Forces,
                (_, true) => BenchmarkKind::Stresslets,
                _ => BenchmarkKind::All,
            },
            repeats: self.repeats,
            with_error: !self.no_error,
            fixed: Fixed { method, device, grid: self.grid.map(|m| [m; 3]), ..Fixed::default() },
            costs,
        }
    }
}
