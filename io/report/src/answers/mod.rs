//! The answers of a run: the quantities that a scene of its kind is run for, as means in the steady state with errors
//! and verdicts, from its time series and the statistics that it has taken.

mod course;
mod grains;
mod sampled;
mod suspension;
mod table;
#[cfg(test)]
mod tests;
mod text;

pub use course::PlainMean;
use course::{ALL, Course, means};
use files::{FileError, Observables, SceneHistory};
use sampled::StatisticsSummary;
use scene::{Kind, Scene};
use std::path::Path;
pub use table::{RunAnswer, read_answers, verdict_word, write_answers};
pub use text::{answers_in_json, answers_in_lines, value_in_words, verdict_in_words};

/// With what the names of quantities begin that are over a scale of the scene.
const REDUCED: &str = "reduced_";

/// The times of a run that its answers are of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnswerRange {
    /// The time from which means are taken; where there is none the transient is left out that is found.
    pub from: Option<f64>,
    /// The time until which they are taken.
    pub until: f64,
}

impl AnswerRange {
    /// All times from the one on that a scene names, or but the transient.
    pub fn of_scene(scene: &Scene) -> Self {
        Self { from: scene.kind().answers_from(), until: f64::INFINITY }
    }

    /// The same of the run in a folder, which may have gone on with another time than that of the scene at its start.
    pub fn of_run(folder: &Path, scene: &Scene) -> Self {
        let of_scene = Self::of_scene(scene);
        let history = SceneHistory::of_folder(folder);
        match history.as_ref().and_then(|history| history.latest("answers.from")) {
            Some(change) => Self { from: change.after.as_ref().and_then(|from| from.parse().ok()), ..of_scene },
            None => of_scene,
        }
    }
}

/// The answers of the run in a folder, of a scene; none where it has no time series.
pub fn run_answers(folder: &Path, scene: &Scene, range: &AnswerRange) -> Result<Vec<RunAnswer>, FileError> {
    let series = series(folder)?;
    let (courses, begins) = courses(scene, &series);
    let mut answers = means(courses, &series.times, range, begins);
    answers.extend(diffusivities(folder, scene)?);
    Ok(answers)
}

/// The mean of each quantity over the second half of a run, whatever its verdict: to be compared with runs of the same
/// length, where the spread over seeds gives the error. Diffusivities are those of the answers.
pub fn second_half(folder: &Path, scene: &Scene) -> Result<Vec<PlainMean>, FileError> {
    let series = series(folder)?;
    let (courses, begins) = courses(scene, &series);
    let from = begins.max(0.5 * series.times.last().copied().unwrap_or(0.0));
    let means = courses.iter().flat_map(|course| course.plain_means(&series.times, from));
    let sampled = diffusivities(folder, scene)?.into_iter().map(|answer| PlainMean {
        quantity: answer.quantity,
        species: answer.species,
        value: answer.mean.value,
    });
    Ok(means.chain(sampled).collect())
}

fn series(folder: &Path) -> Result<Observables, FileError> {
    let is_wanted =
        |name: &str| suspension::RecordedSuspension::COLUMNS.contains(&name) || grains::COLUMNS.contains(&name);
    Ok(Observables::of_folder(folder, &is_wanted)?.unwrap_or_default())
}

/// The quantities of a series, and the time from which they may be steady.
fn courses(scene: &Scene, series: &Observables) -> (Vec<Course>, f64) {
    match scene.kind() {
        Kind::Suspension(scene) => {
            let run = suspension::RecordedSuspension { model: &scene.model, series };
            (run.courses(), run.begins())
        }
        Kind::GranularDisks(_) => (grains::of_disks(series), 0.0),
        Kind::ShearCell(scene) => (grains::of_shear_cell(series), grains::measured_from(scene)),
        Kind::Continuum(_) => (Vec::new(), 0.0),
    }
}

fn diffusivities(folder: &Path, scene: &Scene) -> Result<Vec<RunAnswer>, FileError> {
    let Kind::Suspension(scene) = scene.kind() else { return Ok(Vec::new()) };
    Ok(StatisticsSummary::read(folder)?.map(|summary| summary.diffusivities(&scene.model)).unwrap_or_default())
}
