//! A page about a run: what was run, its course, charts of its time series and statistics, and its scene.

mod about;
mod base64;
mod chart;
mod charts;
mod error;
mod facts;
mod html;
mod observables;
mod origin;
mod page;
mod playback;
mod stored_table;
mod tables;
#[cfg(test)]
mod tests;
mod warnings;

use crate::recorded::Recorded;
use crate::{FileError, durable};
use about::About;
pub use error::ReportError;
use facts::Course;
use observables::Observables;
use origin::Origin;
use page::Page;
use playback::Playback;
use std::path::Path;
use stored_table::StoredTable;

/// Files of tables that a run leaves, and the statistics that are made of it afterwards.
const TABLES: [&str; 3] = ["averages.h5", "sweep.h5", "solution.h5"];
const STATISTICS: [&str; 2] = ["statistics/statistics.h5", "stats/statistics.h5"];

/// Writes a page about the run in a folder: one HTML file, which needs no network and no other file. It appears under its
/// name when it is whole. What is damaged of the results and can be left out is, and the page says so.
pub fn write_report(folder: &Path, out: &Path) -> Result<(), ReportError> {
    if out.exists() && !out.is_file() {
        return Err(FileError::write(out, &"it is no file").into());
    }
    let origin = Origin::of(folder)?;
    let about = About::of(&origin);
    let trajectory = trajectory(&folder.join("trajectory.h5"))?;
    let playback = trajectory.as_ref().map(|recorded| Playback::of(recorded, &about.colours()));
    let series = Observables::read(&folder.join("observables.h5"))?.unwrap_or_default();
    let stored = stored_tables(folder)?;
    let course = Course { trajectory: trajectory.as_ref().zip(playback.as_ref()), series: &series };
    let name = folder.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    let page = Page {
        title: about.title().unwrap_or(name.as_deref().unwrap_or("A run")),
        facts: &facts::facts(&about, &origin, &course),
        warnings: &warnings::warnings(&about, &course, &stored),
        playback: playback.as_ref().map(|playback| (playback, about.up())),
        charts: &charts::charts(&about, &series, &stored),
        tables: &tables::tables(&stored),
        plan: &origin.plan,
        scene: &origin.scene,
    };
    Ok(durable::replace(out, page.html().as_bytes())?)
}

/// The trajectory, if the run wrote one.
fn trajectory(path: &Path) -> Result<Option<Recorded>, FileError> {
    if path.is_file() { Recorded::open(path).map(Some) } else { Ok(None) }
}

fn stored_tables(folder: &Path) -> Result<Vec<StoredTable>, FileError> {
    let statistics = STATISTICS.into_iter().find(|name| folder.join(name).is_file());
    let files = TABLES.into_iter().chain(statistics);
    let tables = files.map(|name| StoredTable::all(&folder.join(name))).collect::<Result<Vec<_>, _>>()?;
    Ok(tables.into_iter().flatten().collect())
}
