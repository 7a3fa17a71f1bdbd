//! Tables of results, as CSV for reading and as HDF5 for programs.

use crate::{FileError, Provenance, durable, text, whole};
use hdf5::File;
use hdf5::types::VarLenUnicode;
use std::fmt::Write as _;
use std::path::Path;

/// A table: some columns of words that say what a row is of, and columns of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Its name in files.
    pub name: &'static str,
    /// Names of the columns of words.
    pub labels: &'static [&'static str],
    /// Names and units of the columns of numbers.
    pub columns: Vec<(String, &'static str)>,
    /// The words and numbers of each row.
    pub rows: Vec<(Vec<String>, Vec<f64>)>,
}

impl Table {
    /// A table without rows.
    pub fn new(name: &'static str, labels: &'static [&'static str], columns: &[(&str, &'static str)]) -> Self {
        let columns = columns.iter().map(|&(name, unit)| (name.to_owned(), unit)).collect();
        Self { name, labels, columns, rows: Vec::new() }
    }

    /// Adds a row.
    pub fn add(&mut self, words: &[&str], numbers: &[f64]) {
        assert_eq!((words.len(), numbers.len()), (self.labels.len(), self.columns.len()), "a value for each column");
        self.rows.push((words.iter().map(|&word| word.to_owned()).collect(), numbers.to_vec()));
    }

    /// The table as CSV; words with commas or quotes are quoted.
    pub fn to_csv(&self) -> String {
        let names = self.labels.iter().map(|&name| name.to_owned()).chain(self.columns.iter().map(|c| c.0.clone()));
        let mut csv = names.collect::<Vec<_>>().join(",") + "\n";
        for (words, numbers) in &self.rows {
            let words = words.iter().map(|word| quoted(word));
            let cells: Vec<String> = words.chain(numbers.iter().map(|number| format!("{number:?}"))).collect();
            writeln!(csv, "{}", cells.join(",")).expect("text grows");
        }
        csv
    }

    /// The rows of a CSV file that has the columns of this table, which has no words.
    pub fn read_rows(&self, path: &Path) -> Result<Vec<Vec<f64>>, FileError> {
        let csv = std::fs::read_to_string(path).map_err(|e| FileError::read(path, &e))?;
        let mut lines = csv.lines();
        let expected = self.columns.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(",");
        if lines.next() != Some(&expected) {
            return Err(FileError::damaged(path, &format!("its first line is not {expected}")));
        }
        let row = |line: &str| line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>();
        let rows: Vec<Vec<f64>> = lines.map(row).collect::<Result<_, _>>().map_err(|e| FileError::damaged(path, &e))?;
        match rows.iter().find(|row| row.len() != self.columns.len()) {
            Some(row) => Err(FileError::damaged(path, &format!("it has a row of {} numbers", row.len()))),
            None => Ok(rows),
        }
    }

    fn write(&self, file: &File) -> hdf5::Result<()> {
        let group = file.create_group(self.name)?;
        for (place, name) in self.labels.iter().enumerate() {
            let words: Vec<VarLenUnicode> = self.rows.iter().map(|(words, _)| text::scalar(&words[place])).collect();
            group.new_dataset_builder().with_data(&words).create(*name)?;
        }
        for (place, (name, unit)) in self.columns.iter().enumerate() {
            let numbers: Vec<f64> = self.rows.iter().map(|(_, numbers)| numbers[place]).collect();
            let dataset = group.new_dataset_builder().with_data(&numbers).create(name.as_str())?;
            text::write_dimensions(&dataset, unit)?;
        }
        Ok(())
    }
}

/// Writes tables into a folder, which is made: each as a CSV file of its own, all together as `NAME.h5`. Files of those
/// names are replaced at once.
pub fn write_tables(folder: &Path, name: &str, provenance: &Provenance, tables: &[Table]) -> Result<(), FileError> {
    std::fs::create_dir_all(folder).map_err(|e| FileError::write(folder, &e))?;
    for table in tables {
        durable::replace(&folder.join(table.name).with_extension("csv"), table.to_csv().as_bytes())?;
    }
    whole::write(&folder.join(name).with_extension("h5"), |file| {
        provenance.write(file)?;
        tables.iter().try_for_each(|table| table.write(file))
    })
}

fn quoted(word: &str) -> String {
    if word.contains([',', '"', '\n']) { format!("\"{}\"", word.replace('"', "\"\"")) } else { word.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_the_same_in_both_files() {
        let folder = tempfile::tempdir().unwrap();
        let provenance =
            Provenance { scene: "a = 1".into(), program: "test 1".into(), plan: "none".into(), ranks: 1, seed: 2 };
        let mut table = Table::new("sizes", &["species"], &[("length", "length"), ("share", "")]);
        table.add(&["small"], &[0.1, 0.5]);
        table.add(&["large, \"round\""], &[2.0, f64::NAN]);
        for _ in 0..2 {
            write_tables(folder.path(), "all", &provenance, &[table.clone()]).unwrap();
        }
        let csv = std::fs::read_to_string(folder.path().join("sizes.csv")).unwrap();
        assert_eq!(csv, "species,length,share\nsmall,0.1,0.5\n\"large, \"\"round\"\"\",2.0,NaN\n");
        let file = File::open(folder.path().join("all.h5")).unwrap();
        assert_eq!(file.dataset("sizes/length").unwrap().read_raw::<f64>().unwrap(), [0.1, 2.0]);
        let words = file.dataset("sizes/species").unwrap().read_raw::<VarLenUnicode>().unwrap();
        assert_eq!(words[1].as_str(), "large, \"round\"");
    }

    #[test]
    fn a_table_of_numbers_can_be_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sizes.csv");
        let mut table = Table::new("sizes", &[], &[("length", "length"), ("share", "")]);
        table.add(&[], &[1.0 / 3.0, -1e-300]);
        table.add(&[], &[f64::INFINITY, 0.0]);
        std::fs::write(&path, table.to_csv()).unwrap();
        assert_eq!(table.read_rows(&path).unwrap(), [[1.0 / 3.0, -1e-300], [f64::INFINITY, 0.0]]);
        let other = Table::new("sizes", &[], &[("length", "length")]);
        let error = other.read_rows(&path).unwrap_err().to_string();
        assert!(error.contains("sizes.csv is damaged: its first line is not length"), "{error}");
        std::fs::write(&path, "length,share\n1.0\n").unwrap();
        assert!(table.read_rows(&path).unwrap_err().to_string().contains("it has a row of 1 numbers"));
    }
}
