//! Warnings about a run and its results.

use crate::about::About;
use crate::facts::RunProgress;
use domain::Number;
use files::StoredTable;
use scene::Kind;

/// Number of damaged parts that are listed; further ones are only counted.
const TOLD: usize = 5;

/// The warnings that follow from the results.
pub(super) fn warnings(about: &About, course: &RunProgress, tables: &[StoredTable]) -> Vec<String> {
    let mut warnings = Vec::new();
    let steps = about.kind().map_or(0, Kind::steps);
    if let Some(last) = course.last_step().filter(|&last| last < steps && !is_due_later(about, last, steps)) {
        warnings.push(format!("The run is not finished: its results end at step {last} of {steps}."));
    }
    warnings.extend(overlaps(course));
    warnings.extend(tables.iter().find_map(dilute));
    warnings.extend(about.family().and_then(|_| without_means(tables)));
    let frames = course.trajectory.map_or(&[][..], |(_, playback)| &playback.damage);
    warnings.extend(told("trajectory.h5", frames));
    warnings.extend(told("observables.h5", &course.series.damage));
    warnings
}

/// Whether no output was due between a step and the end.
fn is_due_later(about: &About, last: u64, steps: u64) -> bool {
    let Some(output) = about.kind().and_then(Kind::output) else { return true };
    let next = [output.trajectory, output.observables].into_iter().filter_map(|schedule| schedule.next_after(last));
    next.min().is_none_or(|next| next > steps)
}

/// Warning if spheres overlap in rows of the time series.
fn overlaps(course: &RunProgress) -> Option<String> {
    let gaps: Vec<f64> = course.series.get("smallest_gap")?.column(0, 0).collect();
    let overlapping = gaps.iter().filter(|&&gap| gap < 0.0).count();
    let deepest = gaps.iter().copied().fold(0.0, f64::min);
    (overlapping > 0).then(|| {
        let deepest = Number(-deepest);
        format!("Spheres overlap in {overlapping} of {} rows of the time series, by {deepest:.3} at most.", gaps.len())
    })
}

/// Warning if solutions of a continuum are dilute, while the theory is meant for dense ones.
fn dilute(table: &StoredTable) -> Option<String> {
    let count = table.numbers("dilute")?.0.iter().filter(|&&dilute| dilute != 0.0).count();
    (count > 0).then(|| format!("{count} of {} solutions are dilute.", table.rows()))
}

/// A family in which no quantity has a mean, so that there is no chart.
fn without_means(tables: &[StoredTable]) -> Option<String> {
    let mut means = tables.iter().filter_map(|table| table.numbers("mean")).flat_map(|(means, _)| means);
    let is_without = !tables.is_empty() && !means.any(|mean| mean.is_finite());
    is_without.then(|| "No quantity has a mean: its runs are too short for any value, see their verdicts.".to_owned())
}

fn told(file: &str, damage: &[String]) -> Vec<String> {
    let mut told: Vec<String> = damage.iter().take(TOLD).map(|what| format!("Left out of {file}: {what}.")).collect();
    if damage.len() > TOLD {
        told.push(format!("Left out of {file}: {} more like these.", damage.len() - TOLD));
    }
    told
}
