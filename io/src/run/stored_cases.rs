//! Stored results of a sweep's runs, so that none is repeated.

use super::{Listener, RunError};
use crate::manifest::SCENE;
use crate::scene::{differences_of, some_of};
use crate::{FileError, Manifest, Scene, read_rows, replace_file};
use domain::{Interrupted, Number};
use drivers::disks::{Case, Record, SweepStore};
use simulation::Table;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

/// Stores each run's records in a file of the folder `cases`.
pub struct StoredCases<'a> {
    run: &'a Manifest,
    folder: PathBuf,
    progress: Mutex<Progress>,
    listener: &'a dyn Listener,
}

/// The progress of the runs.
struct Progress {
    /// The part of each run that is done.
    parts: Vec<f64>,
    /// Runs that are made.
    made: usize,
}

/// The table of one run: what it is of, and a row for each record.
fn table() -> Table {
    let of = [("seed", ""), ("viscosity", "force*time/length^2"), ("rate", "1/time"), ("area_fraction", "")];
    Table::new("case", &[], &[&of[..], &Record::COLUMNS].concat())
}

fn name(case: &Case) -> [f64; 4] {
    [case.seed as f64, case.viscosity, case.rate, case.area_fraction]
}

/// Keys that say which runs there are, or nothing of them.
const MAY_CHANGE: [&str; 6] =
    ["title", "output.folder", "sweep.seeds", "sweep.viscosities", "sweep.rates", "sweep.area_fractions"];

/// Keeps the scene that the runs are of. Refuses another one than that of the runs that are there.
fn keep_scene(run: &Manifest, scene: &Scene, path: &Path) -> Result<(), RunError> {
    if !path.exists() {
        run.enter(path)?;
        return Ok(replace_file(path, scene.text().as_bytes())?);
    }
    let kept = std::fs::read_to_string(path).map_err(|e| FileError::read(path, &e))?;
    let all = differences_of(scene.text(), &kept).map_err(|e| FileError::damaged(path, &e))?;
    let other = all.iter().filter(|difference| !MAY_CHANGE.contains(&difference.key.as_str()));
    let other: Vec<String> = other.map(ToString::to_string).collect();
    if other.is_empty() {
        return Ok(());
    }
    Err(RunError::Refused(format!(
        "{} has runs of another scene: {}; put back what they have, or make the sweep in another folder",
        run.folder().display(),
        some_of(&other)
    )))
}

impl<'a> StoredCases<'a> {
    /// Those of a run's folder, `count` in all, which have to be of this scene.
    pub fn of(run: &'a Manifest, scene: &Scene, count: usize, listener: &'a dyn Listener) -> Result<Self, RunError> {
        let folder = run.folder().join("cases");
        run.make_folder(&folder)?;
        keep_scene(run, scene, &folder.join(SCENE))?;
        let progress = Mutex::new(Progress { parts: vec![0.0; count], made: 0 });
        Ok(Self { run, folder, progress, listener })
    }

    fn path(&self, case: &Case) -> PathBuf {
        self.folder.join(format!("{:04}.csv", case.index))
    }

    fn progress(&self) -> MutexGuard<'_, Progress> {
        self.progress.lock().expect("nobody who holds it panics")
    }

    fn show(&self, case: &Case, part: f64) {
        let mut progress = self.progress();
        progress.parts[case.index] = part;
        self.listener.part(progress.parts.iter().sum::<f64>() / progress.parts.len() as f64);
    }

    fn say(&self, case: &Case, what: &str) {
        let Case { seed, viscosity, rate, area_fraction, .. } = case;
        let [viscosity, rate, area_fraction] = [viscosity, rate, area_fraction].map(|&value| Number(value));
        let run = format!("seed {seed}, viscosity {viscosity}, rate {rate}, area fraction {area_fraction}");
        let mut progress = self.progress();
        progress.made += 1;
        self.listener.line(&format!("run {} of {}: {run}{what}", progress.made, progress.parts.len()));
        drop(progress);
        self.show(case, 1.0);
    }
}

impl SweepStore for StoredCases<'_> {
    type Error = RunError;

    fn stored(&self, case: &Case) -> Result<Option<Vec<Record>>, RunError> {
        let path = self.path(case);
        if !path.exists() {
            return Ok(None);
        }
        let rows = read_rows(&table(), &path)?;
        let record = |row: &Vec<f64>| {
            let (of, values) = row.split_at(name(case).len());
            let values = values.try_into().expect("the columns were counted");
            (of == name(case)).then(|| Record::of(values))
        };
        let other = || RunError::Refused(format!("{} has another run than this sweep's; move it away", path.display()));
        let records = rows.iter().map(record).collect::<Option<_>>().ok_or_else(other)?;
        self.say(case, ", made before");
        Ok(Some(records))
    }

    fn store(&self, case: &Case, records: &[Record]) -> Result<(), RunError> {
        let mut table = table();
        for record in records {
            table.add(&[], &[&name(case)[..], &record.values()].concat());
        }
        let path = self.path(case);
        self.run.enter(&path)?;
        replace_file(&path, table.to_csv().as_bytes())?;
        self.listener.stored();
        self.say(case, "");
        Ok(())
    }

    fn go_on(&self) -> Result<(), RunError> {
        if self.listener.goes_on() { Ok(()) } else { Err(Interrupted.into()) }
    }

    fn tell(&self, case: &Case, part: f64) {
        self.show(case, part);
    }
}
