//! Reader of tables of results.

use crate::{FileError, checksum, claimed_size, self_contained, text};
use domain::Number;
use hdf5::types::{TypeDescriptor, VarLenUnicode};
use hdf5::{Dataset, Group};
use std::path::Path;

/// A table of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredTable {
    /// Name.
    pub name: String,
    columns: Vec<(String, TableColumn)>,
}

#[derive(Debug, Clone, PartialEq)]
enum TableColumn {
    Words(Vec<String>),
    /// Numbers with their unit.
    Numbers(Vec<f64>, String),
}

impl StoredTable {
    /// Tables of a file; empty if there is no such file.
    pub fn all(path: &Path) -> Result<Vec<Self>, FileError> {
        if !path.is_file() {
            return Ok(Vec::new());
        }
        Self::try_all(path).map_err(|e| FileError::damaged(path, &e))
    }

    fn try_all(path: &Path) -> hdf5::Result<Vec<Self>> {
        let groups = self_contained::open(path)?.groups()?.into_iter();
        let tables = groups.filter(|group| !["/h5md", "/parameters"].contains(&group.name().as_str()));
        tables.map(|group| Self::read(&group)).collect()
    }

    fn read(group: &Group) -> hdf5::Result<Self> {
        let name = |path: String| path.rsplit('/').next().unwrap_or_default().to_owned();
        let datasets = group.datasets()?;
        let columns = datasets.iter().map(|dataset| Ok((name(dataset.name()), TableColumn::read(dataset)?)));
        let read = Self { name: name(group.name()), columns: columns.collect::<hdf5::Result<_>>()? };
        if read.columns.iter().any(|(_, column)| column.len() != read.rows()) {
            return Err(format!("the columns of {} differ in length", read.name).into());
        }
        Ok(read)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, column)| column.len())
    }

    fn get(&self, name: &str) -> Option<&TableColumn> {
        self.columns.iter().find(|(column, _)| column == name).map(|(_, column)| column)
    }

    /// Names of the columns of numbers.
    pub fn number_names(&self) -> impl Iterator<Item = &str> {
        self.columns
            .iter()
            .filter(|(_, column)| matches!(column, TableColumn::Numbers(..)))
            .map(|(name, _)| name.as_str())
    }

    /// The numbers of a column with their unit.
    pub fn numbers(&self, name: &str) -> Option<(&[f64], &str)> {
        match self.get(name)? {
            TableColumn::Numbers(numbers, unit) => Some((numbers, unit)),
            TableColumn::Words(_) => None,
        }
    }

    /// Text of a cell: words, or a number with a few digits; empty if there is no such column.
    pub fn cell(&self, name: &str, row: usize) -> String {
        match self.get(name) {
            Some(TableColumn::Words(words)) => words[row].clone(),
            Some(TableColumn::Numbers(numbers, _)) => format!("{:.4}", Number(numbers[row])),
            None => String::new(),
        }
    }

    /// Text of a cell, with all digits of a number.
    fn word(&self, name: &str, row: usize) -> String {
        match self.get(name) {
            Some(TableColumn::Numbers(numbers, _)) => Number(numbers[row]).to_string(),
            _ => self.cell(name, row),
        }
    }

    /// Groups of rows with equal cells in these columns, and those cells, in the order of their first rows.
    pub fn groups(&self, columns: &[&str]) -> Vec<(Vec<String>, Vec<usize>)> {
        let mut groups: Vec<(Vec<String>, Vec<usize>)> = Vec::new();
        for row in 0..self.rows() {
            let of: Vec<String> = columns.iter().map(|column| self.word(column, row)).collect();
            match groups.iter_mut().find(|(name, _)| *name == of) {
                Some((_, rows)) => rows.push(row),
                None => groups.push((of, vec![row])),
            }
        }
        groups
    }

    /// Points from two columns in the given rows, and standard errors from the column named like the second with
    /// `_error` appended. `None` if either column is missing.
    pub fn points(&self, x: &str, y: &str, rows: &[usize]) -> Option<(Vec<[f64; 2]>, Vec<f64>)> {
        let ((x, _), (values, _)) = (self.numbers(x)?, self.numbers(y)?);
        let errors = self.numbers(&format!("{y}_error")).map_or(&[][..], |(errors, _)| errors);
        let points = rows.iter().map(|&row| [x[row], values[row]]).collect();
        Some((points, rows.iter().filter_map(|&row| errors.get(row).copied()).collect()))
    }
}

impl TableColumn {
    fn read(dataset: &Dataset) -> hdf5::Result<Self> {
        claimed_size::check(dataset)?;
        if matches!(dataset.dtype()?.to_descriptor()?, TypeDescriptor::VarLenUnicode) {
            let words = dataset.read_raw::<VarLenUnicode>()?;
            return Ok(Self::Words(words.iter().map(ToString::to_string).collect()));
        }
        Ok(Self::Numbers(checksum::read(dataset)?, text::read_dimensions(dataset)))
    }

    fn len(&self) -> usize {
        match self {
            Self::Words(words) => words.len(),
            Self::Numbers(numbers, _) => numbers.len(),
        }
    }
}
