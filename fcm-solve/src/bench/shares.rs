//! `fcm-solve bench --serial` and `--step`: stages inside and outside of parallel loops.

use crate::prepared_scene::{PreparedScene, prepared};
use crate::scene_file;
use crate::streams;
use anyhow::{bail, ensure};
use domain::parallel::{self, ParallelProfile};
use domain::{Comm, Interrupt};
use serde::Serialize;
use simulation::Simulation;
use std::path::Path;
use std::time::Duration;
use suspension::benchmark::{BenchmarkCase, Shares, Stages, measured_machine};

/// Steps before those that are measured: until motions are extrapolated from previous ones.
const WARM_UP: u64 = 6;

/// Stages of evaluations.
#[derive(Serialize)]
struct EvaluationLine {
    #[serde(flatten)]
    case: BenchmarkCase,
    tolerance: f64,
    grid: [usize; 3],
    threads: usize,
    bandwidth: [f64; 2],
    with_lists: Shares,
    repeated: Shares,
}

/// Stages of steps.
#[derive(Serialize)]
struct StepLine<'a> {
    scene: &'a Path,
    particles: usize,
    threads: usize,
    bandwidth: [f64; 2],
    start: Shares,
    step: Shares,
    observables: Shares,
}

/// Prints the stages of evaluations.
pub fn print_evaluations(case: BenchmarkCase, tolerance: f64, stages: &Stages, comm: &Comm) -> anyhow::Result<()> {
    let machine = measured_machine();
    let line = EvaluationLine {
        case,
        tolerance,
        grid: stages.plan.grid,
        threads: rayon::current_num_threads(),
        bandwidth: [machine.bandwidth_of_one, machine.bandwidth],
        with_lists: Shares::of(&stages.with_lists, 1.0, &machine),
        repeated: Shares::of(&stages.repeated, 1.0, &machine),
    };
    streams::print(comm, &(serde_json::to_string(&line)? + "\n"))
}

/// Measures the start and some steps of a scene, and prints their stages. Collective.
pub fn measure_steps(scene: &Path, steps: u32, comm: &Comm) -> anyhow::Result<()> {
    let PreparedScene { scene: whole, .. } = prepared(scene_file::read(scene, &[], comm)?, true, comm)?;
    ensure!(whole.kind().output().is_some(), "{} does not advance in steps", scene.display());
    let machine = measured_machine();
    let (started, start) = parallel::measure(thread_time, || run::start(&whole, comm, &mut |_| {}));
    let mut simulation = started?;
    simulation.listen(Interrupt::NEVER);
    advance(&mut *simulation, WARM_UP)?;
    let (taken, step) = parallel::measure(thread_time, || advance(&mut *simulation, steps.into()));
    taken?;
    let (_, observables) = parallel::measure(thread_time, || simulation.observe());
    let mut particles = [simulation.frame_share().particles.len() as f64];
    comm.sum(&mut particles);
    let of = |profile: &ParallelProfile, times: f64| Shares::of(profile, times, &machine);
    let line = StepLine {
        scene,
        particles: particles[0] as usize,
        threads: rayon::current_num_threads(),
        bandwidth: [machine.bandwidth_of_one, machine.bandwidth],
        start: of(&start, 1.0),
        step: of(&step, steps.into()),
        observables: of(&observables, 1.0),
    };
    streams::print(comm, &(serde_json::to_string(&line)? + "\n"))
}

/// Time that this thread had on a core.
pub fn thread_time() -> Duration {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the call writes one time to the given address.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// Takes a number of steps.
fn advance(simulation: &mut dyn Simulation, steps: u64) -> anyhow::Result<()> {
    let last = simulation.clock().step() + steps;
    while simulation.clock().step() < last {
        let before = simulation.clock().step();
        simulation.advance(last)?;
        if simulation.clock().step() == before {
            bail!("the simulation was interrupted at step {before}");
        }
    }
    Ok(())
}
