//! Reading the time series of a run.

use crate::frames::Sums;
use crate::{FileError, claimed_size, stored_inside, text};
use hdf5::Group;
use hdf5::types::VarLenUnicode;
use simulation::csv_words;
use std::path::Path;

/// The time series of a run: all complete rows.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Observables {
    /// Times of the rows.
    pub(super) times: Vec<f64>,
    /// The step of the last row in the file.
    pub(super) last_step: Option<u64>,
    /// The quantities.
    pub(super) quantities: Vec<Observed>,
    /// Damaged rows, which are left out, with the damage of each.
    pub(super) damage: Vec<String>,
}

/// One quantity of a time series.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Observed {
    /// Its name.
    pub(super) name: String,
    /// Its unit.
    pub(super) unit: String,
    /// Names of the rows of a table, such as species; of a number, none.
    pub(super) rows: Vec<String>,
    /// Names of its columns, such as components.
    pub(super) columns: Vec<String>,
    /// For each time the numbers, row by row.
    values: Vec<f64>,
}

impl Observables {
    /// Reads the file. `None` if a run wrote no such file.
    pub(super) fn read(path: &Path) -> Result<Option<Self>, FileError> {
        if !path.is_file() {
            return Ok(None);
        }
        Self::try_read(path).map(Some).map_err(|e| FileError::damaged(path, &e))
    }

    fn try_read(path: &Path) -> hdf5::Result<Self> {
        let file = stored_inside::open(path)?;
        let groups = file.group("observables")?.groups()?;
        let Some(clock) = groups.first() else { return Err("it has no observables".into()) };
        let (steps, times): (Vec<u64>, Vec<f64>) =
            (claimed_size::read(clock, "step")?, claimed_size::read(clock, "time")?);
        let count = steps.len().min(times.len());
        let quantities = groups.iter().map(|group| Observed::read(group, count)).collect::<hdf5::Result<_>>()?;
        let times = times[..count].to_vec();
        let read = Self { times, last_step: steps.last().copied(), quantities, damage: Vec::new() };
        Ok(match Sums::open(&file)? {
            Some(sums) => read.without_damage(&sums),
            None => read,
        })
    }

    fn without_damage(mut self, sums: &Sums) -> Self {
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
    pub(super) fn get(&self, name: &str) -> Option<&Observed> {
        self.quantities.iter().find(|quantity| quantity.name == name)
    }

    /// The line of a quantity of this name that is a number, over the times.
    pub(super) fn line(&self, name: &str) -> Option<(&Observed, Vec<[f64; 2]>)> {
        let quantity = self.get(name)?;
        Some((quantity, self.over_time(quantity.column(0, 0))))
    }

    /// Values over the times.
    pub(super) fn over_time(&self, values: impl Iterator<Item = f64>) -> Vec<[f64; 2]> {
        self.times.iter().zip(values).map(|(&time, value)| [time, value]).collect()
    }
}

impl Observed {
    fn read(group: &Group, count: usize) -> hdf5::Result<Self> {
        let dataset = claimed_size::dataset(group, "value")?;
        let names = |attribute: &str| -> hdf5::Result<Vec<String>> {
            let Ok(attribute) = group.attr(attribute) else { return Ok(Vec::new()) };
            Ok(csv_words(&attribute.read_scalar::<VarLenUnicode>()?))
        };
        let name = group.name().rsplit('/').next().unwrap_or_default().to_owned();
        let (rows, columns) = (names("rows")?, names("columns")?);
        let mut read = Self { name, unit: text::read_dimensions(&dataset), rows, columns, values: dataset.read_raw()? };
        let needed = count * read.width();
        if read.values.len() < needed {
            return Err(format!("{} has {} numbers, but needs {needed}", group.name(), read.values.len()).into());
        }
        read.values.truncate(needed);
        Ok(read)
    }

    /// Numbers at a time.
    fn width(&self) -> usize {
        self.rows.len().max(1) * self.columns.len().max(1)
    }

    /// The numbers in a row and a column of the table, over the times.
    pub(super) fn column(&self, row: usize, column: usize) -> impl Iterator<Item = f64> {
        let place = row * self.columns.len().max(1) + column;
        self.values.chunks_exact(self.width()).map(move |values| values[place])
    }
}
