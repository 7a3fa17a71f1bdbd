//! The page of a run: a description, a player of the trajectory, charts of time series and statistics, and the scene.

use crate::about::About;
use crate::error::ReportError;
use crate::facts::RunProgress;
use crate::page::Page;
use crate::playback::Playback;
use crate::{AnswerRange, answer_table, charts, facts, run_answers, tables, warnings};
use files::{
    FileError, Manifest, Observables, Provenance, REPORT_START, RecordedContacts, StoredTable, TrajectoryReader,
    replace_file, starts_with,
};
use std::path::Path;

/// Files of tables that a run writes, and of statistics computed afterwards.
const TABLES: [&str; 3] = ["averages.h5", "solution.h5", "family.h5"];
const STATISTICS: [&str; 2] = ["statistics/statistics.h5", "stats/statistics.h5"];

/// Writes a page about the run in a folder: one HTML file, which needs no network and no other file. It appears under
/// its name when it is complete. Damaged frames and rows are left out, and the page says so.
pub fn write_report(folder: &Path, out: &Path) -> Result<(), ReportError> {
    if out.exists() && !out.is_file() {
        return Err(FileError::write(out, &"it is no file").into());
    }
    let provenance = provenance(folder)?;
    let about = About::of(&provenance.scene);
    let trajectory = trajectory(&folder.join("trajectory.h5"))?;
    let contacts = RecordedContacts::of(folder)?;
    let playback = trajectory.as_ref().map(|recorded| Playback::of(recorded, &contacts, &about.colours()));
    let series = Observables::read(&folder.join("observables.h5"))?.unwrap_or_default();
    let stored = stored_tables(folder)?;
    let course = RunProgress { trajectory: trajectory.as_ref().zip(playback.as_ref()), series: &series };
    let answers_of = |scene| run_answers(folder, scene, &AnswerRange::of_run(folder, scene));
    let found = about.scene().map(answers_of).transpose()?;
    let name = folder.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    let page = Page {
        title: about.title().unwrap_or(name.as_deref().unwrap_or("A run")),
        facts: &facts::facts(&about, &provenance, &course),
        answers: &answer_table::table_of(&found.unwrap_or_default()),
        warnings: &warnings::warnings(&about, &course, &stored),
        playback: playback.as_ref().map(|playback| (playback, about.up())),
        charts: &charts::charts(&about, &series, &stored),
        tables: &tables::tables(&stored),
        plan: &provenance.plan,
        scene: &provenance.scene,
    };
    Manifest::of(folder)?.enter_known(out, |path| starts_with(path, REPORT_START.as_bytes()))?;
    Ok(replace_file(out, page.html().as_bytes())?)
}

/// The provenance of the results in a folder.
fn provenance(folder: &Path) -> Result<Provenance, ReportError> {
    Provenance::of_folder(folder)?.ok_or_else(|| no_results(folder))
}

fn no_results(folder: &Path) -> ReportError {
    let is_run = folder.join("scene.toml").exists();
    let folder = folder.to_owned();
    if is_run { ReportError::NoResults { folder } } else { ReportError::NoRun { folder } }
}

/// The trajectory, if the run wrote one.
fn trajectory(path: &Path) -> Result<Option<TrajectoryReader>, FileError> {
    if path.is_file() { TrajectoryReader::open(path).map(Some) } else { Ok(None) }
}

fn stored_tables(folder: &Path) -> Result<Vec<StoredTable>, FileError> {
    let statistics = STATISTICS.into_iter().find(|name| folder.join(name).is_file());
    let files = TABLES.into_iter().chain(statistics);
    let tables = files.map(|name| StoredTable::all(&folder.join(name))).collect::<Result<Vec<_>, _>>()?;
    Ok(tables.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests;
