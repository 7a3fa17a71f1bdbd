//! Forecast of the time and output of a run from a trial of its first steps.

use crate::strain_end::StrainEnd;
use crate::{RunError, start};
use domain::{Comm, Interrupt, Number, readable_bytes};
use files::{SceneRecord, Trajectory, checkpoint};
use scene::{Kind, OutputSchedules, Scene, SuspensionScene};
use simulation::{Outline, Schedule, Simulation, Table};
use std::time::{Duration, Instant};
use suspension::{Forecast, RankCounts, Start, SuspensionRun};

/// Forecast of the time and output of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Seconds until the first step.
    pub start: f64,
    /// Seconds per step.
    pub step: f64,
    /// Seconds of the whole run.
    pub run: f64,
    /// Bytes of all files at the end.
    pub bytes: f64,
    /// The end by a strain, of a run that has one.
    pub(super) strain: Option<StrainEnd>,
    /// Steps that the run takes.
    pub(super) steps: f64,
    /// Steps that were taken.
    pub(super) tried: u64,
    /// Particles of the copy that took them, if it was not the scene itself.
    pub(super) copy: Option<usize>,
}

/// Smallest duration of the trial, if the run has as many steps; smallest fraction of the run that is
/// tried; and largest duration.
const TIME: Duration = Duration::from_millis(300);
const PART: f64 = 0.05;
const MOST_TIME: Duration = Duration::from_secs(1);

/// Time after which a trial on a single rank gives up a step.
const PATIENCE: Duration = Duration::from_secs(5);

/// Number of steps that are not timed, as the extrapolation from earlier steps has not started yet.
const WARM_UP: u64 = 6;

/// Smallest number of timed steps.
const TIMED: u64 = 3;

/// Ratio to the usual time of a step above which a step counts as a rare one.
const RARE: f64 = 4.0;

/// Largest number of spheres and of grains in a trial.
const MOST_SPHERES: f64 = 4000.0;
const MOST_GRAINS: usize = 2000;

/// Largest number of steps of single disks in the preparation of a trial, some seconds.
const MOST_DISK_STEPS: f64 = 5e7;

/// Approximate largest number of evaluations of a trial.
const EVALUATIONS: f64 = 50.0;

/// Bytes of a number in the time series: in HDF5, and as text.
const NUMBER: f64 = 8.0 + 18.0;

/// Seconds for writing to a local disk: a number of a quantity in a row, a frame, a checkpoint, a table of averages
/// with it, a byte; and seconds for launching the program.
const QUANTITY_TIME: f64 = 2e-5;
const FRAME_TIME: f64 = 2e-4;
const CHECKPOINT_TIME: f64 = 4e-3;
const TABLE_TIME: f64 = 1.5e-3;
const BYTE_TIME: f64 = 3e-9;
const LAUNCH_TIME: f64 = 0.01;

/// Bytes of an HDF5 file of frames in addition to its frames.
const FILE: f64 = 2e5;

/// Bytes of all tables of averages, for each species.
const TABLES: f64 = 6e5;

/// Bytes of the velocity at a grid point.
const POINT: f64 = 24.0;

/// Bytes of a contact file without contacts, and of the contacts per sphere: about three, each shared by two spheres.
const CONTACTS_FILE: f64 = 1e4;
const CONTACTS: f64 = 1.5 * 108.0;

/// A simulation for a trial; ratios of the cost of an evaluation and of the number of particles of the run to those
/// of the simulation; and the number of points of the run's velocity fields.
struct TrialSimulation {
    simulation: Box<dyn Simulation>,
    costs: f64,
    particles: f64,
    field_points: f64,
}

impl TrialSimulation {
    fn as_it_is(simulation: Box<dyn Simulation>) -> Self {
        Self { simulation, costs: 1.0, particles: 1.0, field_points: 0.0 }
    }
}

/// Bytes that a run writes, and the time for writing them.
struct OutputForecast {
    bytes: f64,
    seconds: f64,
}

/// Tries the first steps of a scene, with fewer particles if it has many, for less than a second. `None` if that is
/// not possible, or not informative. A scene that cannot start is an error, and one whose first steps fail is a
/// [`RunError::Simulation`]. Collective.
pub fn trial(scene: &Scene, comm: &Comm) -> Result<Option<Trial>, RunError> {
    let Some(output) = scene.kind().output() else { return Ok(None) };
    let began = Instant::now();
    let Some(mut trying) = trying(scene, comm)? else { return Ok(None) };
    let simulation = &mut *trying.simulation;
    let start = agreed(began, comm);
    let last = scene.kind().steps();
    observe(simulation, output);
    // Steps and times at the end of each advance.
    let mut ends = Vec::new();
    let began = Instant::now();
    if comm.size() == 1 {
        simulation.listen(Interrupt::when(move || began.elapsed() > PATIENCE));
    }
    loop {
        let (step, time) = (simulation.clock().step(), agreed(began, comm));
        ends.push((step, time));
        let whole = time / step.max(1) as f64 * steps_of_all(scene, StrainEnd::of(simulation, last));
        let is_enough = time > TIME.as_secs_f64().max(PART * whole) && step >= WARM_UP + TIMED;
        if step >= last || simulation.end_reason().is_some() || is_enough || time > MOST_TIME.as_secs_f64() {
            break;
        }
        match simulation.advance(next(output, step).min(last)) {
            Ok(()) => {}
            Err(_) if trying.particles > 1.0 => return Ok(None),
            Err(error) => return Err(RunError::Simulation(error)),
        }
        observe(simulation, output);
    }
    let tried = simulation.clock().step();
    if tried == 0 {
        return Ok(None);
    }
    let warm = ends.iter().take_while(|(step, _)| *step <= WARM_UP).count() - 1;
    let warm = if warm + 1 < ends.len() { warm } else { 0 };
    let (warm_step, warm_time) = ends[warm];
    let step = trying.costs * usual(&ends[warm..]);
    let course = if let Kind::Suspension(scene) = scene.kind() { suspension::cost_growth(&scene.model) } else { 1.0 };
    let step = step * course;
    let strain = StrainEnd::of(&*trying.simulation, last);
    let all = steps_of_all(scene, strain);
    let steps = step * (all - warm_step as f64).max(0.0);
    let written = written(&mut trying, scene, output, all.ceil() as u64);
    let copy = (trying.particles > 1.0).then(|| trying.simulation.frame().particles.len());
    let start = LAUNCH_TIME + trying.costs * start;
    let run = start + trying.costs * warm_time + steps + written.seconds;
    Ok(Some(Trial { start, step, run, bytes: written.bytes, strain, steps: all, tried, copy }))
}

/// Mean seconds per step, from the steps and times at the ends of intervals. An interval with a time per step many
/// times the median, as when a box that follows its spheres gets another grid, is cut to that multiple of the median.
fn usual(ends: &[(u64, f64)]) -> f64 {
    let mut lengths: Vec<(f64, f64)> = ends
        .windows(2)
        .map(|pair| ((pair[1].0 - pair[0].0) as f64, pair[1].1 - pair[0].1))
        .filter(|(steps, _)| *steps > 0.0)
        .collect();
    lengths.sort_by(|(a, s), (b, t)| (s / a).total_cmp(&(t / b)));
    let Some((steps, seconds)) = lengths.get(lengths.len() / 2) else { return 0.0 };
    let most = RARE * seconds / steps;
    let [all, sum] = lengths.iter().fold([0.0; 2], |[all, sum], (n, t)| [all + n, sum + t.min(most * n)]);
    sum / all
}

/// Longest time since an instant on any rank. Collective.
fn agreed(since: Instant, comm: &Comm) -> f64 {
    let mut seconds = [since.elapsed().as_secs_f64()];
    comm.max(&mut seconds);
    seconds[0]
}

/// Evaluates the results of a step as a run does.
fn observe(simulation: &mut dyn Simulation, output: &OutputSchedules) {
    if output.observables.is_due(simulation.clock().step()) {
        simulation.observe();
    }
    simulation.sample();
}

fn next(output: &OutputSchedules, step: u64) -> u64 {
    let OutputSchedules { trajectory, observables, checkpoints, fields, contacts, .. } = output;
    let due = [trajectory, observables, checkpoints, fields, contacts].into_iter().filter_map(|s| s.next_after(step));
    due.min().unwrap_or(u64::MAX)
}

fn trying(scene: &Scene, comm: &Comm) -> Result<Option<TrialSimulation>, RunError> {
    Ok(match scene.kind() {
        Kind::Suspension(scene) => of_spheres(scene, comm)?,
        Kind::GranularDisks(disks) if disks.start.is_none() && is_long_start(&disks.model) => None,
        Kind::ShearCell(cell) if cell.experiment.count > MOST_GRAINS => None,
        Kind::Continuum(_) => None,
        _ => Some(TrialSimulation::as_it_is(start::start(scene, comm, &mut |_| ())?)),
    })
}

/// Whether the preparation of a random start takes longer than a trial.
fn is_long_start(model: &granular::disks::DiskModel) -> bool {
    let disks = model.sizes().len();
    disks > MOST_GRAINS || model.preparing_steps() as f64 * disks as f64 > MOST_DISK_STEPS
}

/// Spheres from a file are tried themselves, if they are few; other scenes with a reduced copy of similar spheres.
fn of_spheres(scene: &SuspensionScene, comm: &Comm) -> Result<Option<TrialSimulation>, RunError> {
    let placed = start::start_positions(scene, comm)?;
    if scene.model.start == Start::Given {
        let mut count = [placed.as_ref().map_or(0, |placed| placed.positions.len()) as f64];
        comm.max(&mut count);
        if count[0] > MOST_SPHERES {
            return Ok(None);
        }
        return Ok(Some(TrialSimulation::as_it_is(Box::new(SuspensionRun::start(&scene.model, placed, comm)?))));
    }
    let copy = scene.model.with_at_most(MOST_SPHERES);
    let forecasts = copy.as_ref().and_then(|copy| Some((Forecast::of(&scene.model)?, Forecast::of(copy)?, copy)));
    let Some((whole, part, copy)) = forecasts else { return Ok(None) };
    // A flat or long box cannot be made much smaller.
    if part.particles > 2.0 * MOST_SPHERES || part.evaluation * EVALUATIONS > MOST_TIME.as_secs_f64() {
        return Ok(None);
    }
    // A copy may fail to start even if the scene itself starts.
    let Ok(simulation) = SuspensionRun::start(copy, None, comm) else { return Ok(None) };
    Ok(Some(TrialSimulation {
        simulation: Box::new(simulation),
        costs: whole.evaluation / part.evaluation,
        particles: whole.particles / part.particles,
        field_points: whole.field_points,
    }))
}

/// The steps of a run, at most where a strain may end it before.
fn steps_of_all(scene: &Scene, strain: Option<StrainEnd>) -> f64 {
    let most = scene.kind().steps() as f64;
    strain.map_or(most, |end| end.steps(most))
}

/// Bytes and time of the output up to step `last`.
fn written(trying: &mut TrialSimulation, scene: &Scene, output: &OutputSchedules, last: u64) -> OutputForecast {
    let count = |schedule: Schedule| schedule.count_until(last) as f64;
    let [rows, frames] = [output.observables, output.trajectory].map(count);
    let simulation = &mut *trying.simulation;
    let quantities = simulation.quantities();
    let numbers: usize = quantities.iter().map(|quantity| quantity.columns().len()).sum();
    let series = OutputForecast {
        bytes: rows * NUMBER * numbers as f64,
        seconds: rows * QUANTITY_TIME * quantities.len() as f64,
    };
    let now = simulation.frame();
    let frame = trying.particles * Trajectory::frame_bytes(&now) as f64;
    let state = simulation.state();
    let sampled = state.statistics.iter().map(Vec::len).sum::<usize>() as f64;
    let mut shares = [
        checkpoint::bytes_of(&state, &SceneRecord::new(scene.text(), output)) as f64 - sampled,
        now.particles.len() as f64,
        sampled,
    ];
    simulation.comm().sum(&mut shares);
    let [state, particles, sampled] = shares.map(|share| trying.particles * share);
    let tables = simulation.averages().map(|set| set.tables).unwrap_or_default();
    let averages = NUMBER * tables.iter().map(numbers_of).sum::<usize>() as f64;
    let [sampled, averages] = grown(scene, particles, [sampled, averages]);
    let state = state + sampled;
    let contacts = count(output.contacts) * (CONTACTS_FILE + CONTACTS * particles);
    let files = [rows, frames].into_iter().filter(|&count| count > 0.0).count() as f64;
    let fields = count(output.fields) * POINT * trying.field_points;
    // One at the start and one at the end.
    let checkpoints = count(output.checkpoints).max(1.0) + 1.0;
    let a_checkpoint = CHECKPOINT_TIME + TABLE_TIME * tables.len() as f64 + BYTE_TIME * (state + averages);
    OutputForecast {
        bytes: FILE * files
            + frames * frame
            + series.bytes
            + fields
            + contacts
            + averages
            + checkpoint::KEPT as f64 * state,
        seconds: series.seconds
            + frames * (FRAME_TIME + BYTE_TIME * frame)
            + BYTE_TIME * (fields + contacts)
            + checkpoints * a_checkpoint,
    }
}

/// Bytes of the statistics at the end of a run, in a checkpoint and as tables, from the present ones `now`.
fn grown(scene: &Scene, particles: f64, now: [f64; 2]) -> [f64; 2] {
    let Kind::Suspension(scene) = scene.kind() else { return now };
    let model = &scene.model;
    let Some(wanted) = model.statistics else { return now };
    let before = (wanted.from / model.time_step) as u64;
    let samples = wanted.samples.count_until(model.steps) - wanted.samples.count_until(before.min(model.steps));
    let [sampled, tables] = now;
    let at_the_end = RankCounts::alone(particles).state_bytes(model, samples);
    [sampled.max(at_the_end), tables.max(TABLES * model.species.len() as f64)]
}

/// Number of cells of a table.
fn numbers_of(table: &Table) -> usize {
    table.rows.iter().map(|(words, numbers)| words.len() + numbers.len()).sum()
}

impl Trial {
    /// Adds the forecast to an outline.
    #[must_use]
    pub fn add_to(&self, outline: Outline) -> Outline {
        self.add_output_to(self.add_time_to(outline, ""))
    }

    /// Adds the time, `on` ranks if they are not those of the trial.
    pub(super) fn add_time_to(&self, outline: Outline, on: &str) -> Outline {
        let of = match self.copy {
            Some(count) => format!("{} steps of {count} like them", self.tried),
            None => format!("its first {} steps", self.tried),
        };
        let [step, run] = [self.step, self.run].map(time_in_words);
        let outline = outline.line("time", format_args!("about {step} a step and {run} for the run{on}, by {of}"));
        let outline = if let Some(end) = self.strain { end.add_to(outline, self.tried) } else { outline };
        outline
            .value("seconds_to_start", self.start)
            .value("seconds_per_step", self.step)
            .value("seconds_of_run", self.run)
    }

    /// Adds what the run writes.
    #[must_use]
    pub fn add_output_to(&self, outline: Outline) -> Outline {
        outline.line("output", format_args!("about {}", readable_bytes(self.bytes))).value("output_bytes", self.bytes)
    }
}

/// A time with a convenient unit.
pub fn time_in_words(seconds: f64) -> String {
    let (factor, unit) = match seconds {
        s if s < 1e-3 => (1e6, "microseconds"),
        s if s < 1.0 => (1e3, "ms"),
        s if s < 120.0 => (1.0, "s"),
        s if s < 7200.0 => (1.0 / 60.0, "minutes"),
        s if s < 172_800.0 => (1.0 / 3600.0, "hours"),
        _ => (1.0 / 86_400.0, "days"),
    };
    format!("{:.2} {unit}", Number(seconds * factor))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five steps of a second each, except one of 21, which is cut to four.
    #[test]
    fn rare_steps_count_as_some() {
        let found = usual(&[(6, 3.0), (7, 4.0), (8, 5.0), (10, 7.0), (11, 28.0)]);
        assert!((found - 8.0 / 5.0).abs() < 1e-15, "{found}");
        assert!((usual(&[(6, 3.0), (8, 7.0)]) - 2.0).abs() < 1e-15);
    }

    #[test]
    fn preparations_longer_than_a_trial_are_not_tried() {
        let mut parameters = granular::disks::DiskParameters::default();
        let model =
            |parameters: &granular::disks::DiskParameters| granular::disks::DiskModel::new(parameters.clone()).unwrap();
        assert!(!is_long_start(&model(&parameters)));
        parameters.preparation.mixed = 2e7;
        assert!(is_long_start(&model(&parameters)));
    }

    #[test]
    fn times_are_said_in_units_that_fit() {
        let words = [3.2e-5, 0.012, 1.0, 119.0, 600.0, 36_000.0, 864_000.0].map(time_in_words);
        assert_eq!(words[0], "32 microseconds");
        assert_eq!(words[1..4], ["12 ms", "1 s", "119 s"].map(str::to_owned));
        assert_eq!(words[4..], ["10 minutes", "10 hours", "10 days"].map(str::to_owned));
    }
}
