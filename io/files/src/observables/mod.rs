//! Reader of the time series of a run.

mod text_table;

use crate::frames::FrameChecksums;
use crate::{FileError, claimed_size, self_contained, text};
use hdf5::Group;
use hdf5::types::VarLenUnicode;
use simulation::csv_words;
use std::path::Path;
use std::time::Duration;

/// A file that was written within this time may be in the middle of a write. It is read again this often, after pauses.
const FRESH: Duration = Duration::from_secs(2);
const ATTEMPTS: usize = 20;
const PAUSE: Duration = Duration::from_millis(20);

/// The time series of a run: all complete rows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Observables {
    /// Times of the rows.
    pub times: Vec<f64>,
    /// Step of the last row in the file.
    pub last_step: Option<u64>,
    /// The quantities.
    pub quantities: Vec<Observed>,
    /// Damage of the damaged rows, which are left out.
    pub damage: Vec<String>,
}

/// One quantity of a time series.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Observed {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Names of the rows of a table, such as species; empty for a number.
    pub rows: Vec<String>,
    /// Names of the columns, such as components.
    pub columns: Vec<String>,
    /// For each time the numbers, row by row.
    values: Vec<f64>,
}

impl Observables {
    /// Reads the file. `None` if a run wrote no such file.
    pub fn read(path: &Path) -> Result<Option<Self>, FileError> {
        if !path.is_file() {
            return Ok(None);
        }
        Self::settled(path, &|_| true).map(Some)
    }

    /// The time series in the folder of a run, restricted to the quantities that `names` selects: from the table if
    /// the HDF5 file is missing.
    pub fn of_folder(folder: &Path, names: &dyn Fn(&str) -> bool) -> Result<Option<Self>, FileError> {
        let (path, table) = (folder.join("observables.h5"), folder.join("observables.csv"));
        if path.is_file() {
            return Self::settled(&path, names).map(Some);
        }
        if table.is_file() { text_table::read(&table, names).map(Some) } else { Ok(None) }
    }

    /// Reads the file, again if a run is writing it: what is read first may then not fit what is read later.
    fn settled(path: &Path, names: &dyn Fn(&str) -> bool) -> Result<Self, FileError> {
        let mut read = Self::try_read(path, names);
        for _ in 0..ATTEMPTS {
            if read.is_ok() || !is_fresh(path) {
                break;
            }
            std::thread::sleep(PAUSE);
            read = Self::try_read(path, names);
        }
        read.map_err(|e| FileError::damaged(path, &e))
    }

    fn try_read(path: &Path, names: &dyn Fn(&str) -> bool) -> hdf5::Result<Self> {
        let file = self_contained::open(path)?;
        let groups = file.group("observables")?.groups()?;
        let Some(clock) = groups.first() else { return Err("it has no observables".into()) };
        let (steps, times): (Vec<u64>, Vec<f64>) =
            (claimed_size::read(clock, "step")?, claimed_size::read(clock, "time")?);
        let selected = groups.iter().filter(|group| names(&name_of(group)));
        let mut quantities: Vec<Observed> = selected.map(Observed::read).collect::<hdf5::Result<_>>()?;
        let count = complete_rows(steps.len().min(times.len()), &quantities)?;
        for quantity in &mut quantities {
            quantity.values.truncate(count * quantity.width());
        }
        let times = times[..count].to_vec();
        let read = Self { times, last_step: steps[..count].last().copied(), quantities, damage: Vec::new() };
        Ok(match FrameChecksums::open(&file)? {
            Some(sums) => read.without_damage(&sums),
            None => read,
        })
    }

    fn without_damage(mut self, sums: &FrameChecksums) -> Self {
        let mut keep = vec![true; self.times.len()];
        for (row, keep) in keep.iter_mut().enumerate() {
            if let Some(damage) = sums.damage(row) {
                *keep = false;
                self.damage.push(damage.to_string());
            }
        }
        let chosen = |values: &[f64], width: usize| -> Vec<f64> {
            let rows = values.chunks_exact(width.max(1)).zip(&keep);
            rows.filter(|(_, keep)| **keep).flat_map(|(row, _)| row.to_vec()).collect()
        };
        self.times = chosen(&self.times, 1);
        self.quantities.iter_mut().for_each(|quantity| quantity.values = chosen(&quantity.values, quantity.width()));
        self
    }

    /// The quantity of this name.
    pub fn get(&self, name: &str) -> Option<&Observed> {
        self.quantities.iter().find(|quantity| quantity.name == name)
    }

    /// The quantity of this name, which is a single number, and its values over time.
    pub fn line(&self, name: &str) -> Option<(&Observed, Vec<[f64; 2]>)> {
        let quantity = self.get(name)?;
        Some((quantity, self.over_time(quantity.column(0, 0))))
    }

    /// Pairs of time and value.
    pub fn over_time(&self, values: impl Iterator<Item = f64>) -> Vec<[f64; 2]> {
        self.times.iter().zip(values).map(|(&time, value)| [time, value]).collect()
    }
}

/// Whether a file was written in the last seconds.
fn is_fresh(path: &Path) -> bool {
    let written = std::fs::metadata(path).and_then(|file| file.modified());
    written.is_ok_and(|time| time.elapsed().is_ok_and(|age| age < FRESH))
}

fn name_of(group: &Group) -> String {
    group.name().rsplit('/').next().unwrap_or_default().to_owned()
}

/// Number of rows that all quantities have, of `count` times. The quantities of the last row may be missing: a run is
/// writing them, or was stopped while it wrote.
fn complete_rows(count: usize, quantities: &[Observed]) -> hdf5::Result<usize> {
    let shorter = quantities.iter().min_by_key(|quantity| quantity.values.len() / quantity.width());
    match shorter.map(|quantity| (quantity, quantity.values.len() / quantity.width())) {
        Some((quantity, rows)) if rows + 1 < count => {
            Err(format!("observables/{} has {rows} rows, but needs {count}", quantity.name).into())
        }
        Some((_, rows)) => Ok(rows.min(count)),
        None => Ok(count),
    }
}

impl Observed {
    fn read(group: &Group) -> hdf5::Result<Self> {
        let dataset = claimed_size::dataset(group, "value")?;
        let names = |attribute: &str| -> hdf5::Result<Vec<String>> {
            let Ok(attribute) = group.attr(attribute) else { return Ok(Vec::new()) };
            Ok(csv_words(&attribute.read_scalar::<VarLenUnicode>()?))
        };
        let name = name_of(group);
        let (rows, columns) = (names("rows")?, names("columns")?);
        Ok(Self { name, unit: text::read_dimensions(&dataset), rows, columns, values: dataset.read_raw()? })
    }

    /// Number of values per time.
    fn width(&self) -> usize {
        self.rows.len().max(1) * self.columns.len().max(1)
    }

    /// The numbers in a row and a column of the table, over time.
    pub fn column(&self, row: usize, column: usize) -> impl Iterator<Item = f64> {
        let place = row * self.columns.len().max(1) + column;
        self.values.chunks_exact(self.width()).map(move |values| values[place])
    }
}
