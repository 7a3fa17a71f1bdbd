//! Who keeps the runs of a sweep, so that none is made twice.

use crate::preparing::Preparing;
use anyhow::{Context, ensure};
use domain::{Comm, Number};
use drivers::disks::{Case, Keeper, Record};
use io::{Table, replace_file};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

/// Keeps each run's records in a file of the folder `cases`.
pub struct Cases {
    folder: PathBuf,
    progress: Mutex<Progress>,
}

/// How far the runs are.
struct Progress {
    shown: Preparing,
    /// The part of each run that is done.
    parts: Vec<f64>,
    /// Runs that are made.
    made: usize,
}

impl Progress {
    fn show(&mut self, case: &Case, part: f64) {
        self.parts[case.index] = part;
        self.shown.show(self.parts.iter().sum::<f64>() / self.parts.len() as f64);
    }
}

/// The table of one run: what it is of, and a row for each record.
fn table() -> Table {
    let of = [("seed", ""), ("viscosity", "force*time/length^2"), ("rate", "1/time"), ("area_fraction", "")];
    Table::new("case", &[], &[&of[..], &Record::COLUMNS].concat())
}

fn name(case: &Case) -> [f64; 4] {
    [case.seed as f64, case.viscosity, case.rate, case.area_fraction]
}

impl Cases {
    /// Those of a run's folder, `count` in all.
    pub fn of(folder: &Path, count: usize, comm: &Comm) -> anyhow::Result<Self> {
        let folder = folder.join("cases");
        std::fs::create_dir_all(&folder).with_context(|| format!("can't make the folder {}", folder.display()))?;
        let progress = Progress { shown: Preparing::start(comm, "all runs"), parts: vec![0.0; count], made: 0 };
        Ok(Self { folder, progress: Mutex::new(progress) })
    }

    fn path(&self, case: &Case) -> PathBuf {
        self.folder.join(format!("{:04}.csv", case.index))
    }

    fn progress(&self) -> MutexGuard<'_, Progress> {
        self.progress.lock().expect("nobody who holds it panics")
    }

    fn say(&self, case: &Case, what: &str) {
        let Case { seed, viscosity, rate, area_fraction, .. } = case;
        let [viscosity, rate, area_fraction] = [viscosity, rate, area_fraction].map(|&value| Number(value));
        let run = format!("seed {seed}, viscosity {viscosity}, rate {rate}, area fraction {area_fraction}");
        let mut progress = self.progress();
        progress.made += 1;
        progress.shown.say(&format!("run {} of {}: {run}{what}", progress.made, progress.parts.len()));
        progress.show(case, 1.0);
    }
}

impl Keeper for Cases {
    type Error = anyhow::Error;

    fn kept(&self, case: &Case) -> anyhow::Result<Option<Vec<Record>>> {
        let path = self.path(case);
        if !path.exists() {
            return Ok(None);
        }
        let rows = table().read_rows(&path)?;
        let record = |row: &Vec<f64>| {
            let (of, values) = row.split_at(name(case).len());
            ensure!(of == name(case), "{} has another run than this sweep's; move it away", path.display());
            Ok(Record::of(values.try_into().context("the columns were counted")?))
        };
        let records = rows.iter().map(record).collect::<anyhow::Result<_>>()?;
        self.say(case, ", made before");
        Ok(Some(records))
    }

    fn keep(&self, case: &Case, records: &[Record]) -> anyhow::Result<()> {
        let mut table = table();
        for record in records {
            table.add(&[], &[&name(case)[..], &record.values()].concat());
        }
        replace_file(&self.path(case), table.to_csv().as_bytes())?;
        self.say(case, "");
        Ok(())
    }

    fn tell(&self, case: &Case, part: f64) {
        self.progress().show(case, part);
    }
}
