//! Who keeps the runs of a sweep, so that none is made twice.

use crate::streams;
use anyhow::{Context, ensure};
use domain::Number;
use drivers::disks::{Case, Keeper, Record};
use io::{Table, replace_file};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Keeps each run's records in a file of the folder `cases`.
pub struct Cases {
    folder: PathBuf,
    count: usize,
    done: AtomicUsize,
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
    pub fn of(folder: &Path, count: usize) -> anyhow::Result<Self> {
        let folder = folder.join("cases");
        std::fs::create_dir_all(&folder).with_context(|| format!("can't make the folder {}", folder.display()))?;
        Ok(Self { folder, count, done: AtomicUsize::new(0) })
    }

    fn path(&self, case: &Case) -> PathBuf {
        self.folder.join(format!("{:04}.csv", case.index))
    }

    fn say(&self, case: &Case, what: &str) {
        let done = 1 + self.done.fetch_add(1, Ordering::Relaxed);
        let Case { seed, viscosity, rate, area_fraction, .. } = case;
        let [viscosity, rate, area_fraction] = [viscosity, rate, area_fraction].map(|&value| Number(value));
        let run = format!("seed {seed}, viscosity {viscosity}, rate {rate}, area fraction {area_fraction}");
        streams::log(format_args!("run {done} of {}: {run}{what}", self.count));
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
}
