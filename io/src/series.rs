//! Time series of what a run observes, as CSV for reading and as HDF5 for programs.

use crate::durable;
use crate::frames::{Element, Frames};
use crate::{FileError, Provenance};
use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// One quantity of a time series: a number, or a table of numbers such as a vector for each species.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Its name.
    pub name: &'static str,
    /// Its unit, in terms of length, time and force.
    pub unit: &'static str,
    /// Names of the rows and columns of a table.
    pub table: Option<(Vec<String>, Vec<String>)>,
}

impl Quantity {
    /// A quantity that is one number.
    pub fn number(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit, table: None }
    }

    /// A vector for each species.
    pub fn vectors(name: &'static str, unit: &'static str, species: &[String]) -> Self {
        Self { name, unit, table: Some((species.to_vec(), ["x", "y", "z"].map(String::from).to_vec())) }
    }

    fn columns(&self) -> Vec<String> {
        let Some((rows, columns)) = &self.table else { return vec![self.name.to_owned()] };
        rows.iter().flat_map(|row| columns.iter().map(move |column| format!("{}_{column}[{row}]", self.name))).collect()
    }

    fn element(&self) -> Element {
        let shape = self.table.as_ref().map(|(rows, columns)| [rows.len(), columns.len()]);
        Element { path: format!("observables/{}", self.name), shape, whole: false, unit: self.unit }
    }
}

/// A time series that is being written to `observables.csv` and `observables.h5` of a folder.
pub struct Series {
    csv: File,
    csv_path: PathBuf,
    frames: Frames,
}

impl Series {
    /// A series of up to `rows` rows.
    pub fn create(
        folder: &Path,
        provenance: &Provenance,
        quantities: &[Quantity],
        rows: u64,
    ) -> Result<Self, FileError> {
        let csv_path = folder.join("observables.csv");
        durable::replace(&csv_path, header(quantities).as_bytes())?;
        let frames = new_frames(&folder.join("observables.h5"), provenance, quantities, rows)?;
        Ok(Self { csv: for_appending(&csv_path)?, csv_path, frames })
    }

    /// Goes on with the series of a former run after step `last`: later rows are dropped. `rows` is the number of rows
    /// at the end of the run.
    pub fn resume(
        folder: &Path,
        provenance: &Provenance,
        quantities: &[Quantity],
        (last, rows): (u64, u64),
    ) -> Result<Self, FileError> {
        let csv_path = folder.join("observables.csv");
        let text = std::fs::read_to_string(&csv_path).map_err(|e| FileError::read(&csv_path, &e))?;
        let is_kept = |line: &&str| line.split(',').next().and_then(|s| s.parse().ok()).is_none_or(|s: u64| s <= last);
        let kept: String = text.split_inclusive('\n').filter(|l| l.ends_with('\n')).filter(is_kept).collect();
        durable::replace(&csv_path, kept.as_bytes())?;
        let elements: Vec<Element> = quantities.iter().map(Quantity::element).collect();
        let anew = |path: &Path| new_frames(path, provenance, quantities, rows);
        let frames = Frames::resume(&folder.join("observables.h5"), &elements, (last, rows), anew)?;
        Ok(Self { csv: for_appending(&csv_path)?, csv_path, frames })
    }

    /// The step of the last row.
    pub fn last_step(&self) -> Result<Option<u64>, FileError> {
        Ok(self.frames.steps_written()?.last().copied())
    }

    /// Adds a row with the numbers of each quantity in turn.
    pub fn append(&mut self, (step, time): (u64, f64), values: &[Vec<f64>]) -> Result<(), FileError> {
        let mut line = format!("{step},{time:?}");
        for value in values.iter().flatten() {
            write!(line, ",{value:?}").expect("text grows");
        }
        line.push('\n');
        self.csv.write_all(line.as_bytes()).map_err(|e| FileError::write(&self.csv_path, &e))?;
        let values: Vec<_> = values.iter().map(|v| v.as_slice().into()).collect();
        self.frames.append((step, time), &values)
    }
}

fn header(quantities: &[Quantity]) -> String {
    let mut columns = vec!["step".to_owned(), "time".to_owned()];
    columns.extend(quantities.iter().flat_map(Quantity::columns));
    columns.join(",") + "\n"
}

fn for_appending(path: &Path) -> Result<File, FileError> {
    OpenOptions::new().append(true).open(path).map_err(|e| FileError::write(path, &e))
}

fn new_frames(path: &Path, provenance: &Provenance, quantities: &[Quantity], rows: u64) -> Result<Frames, FileError> {
    let elements: Vec<Element> = quantities.iter().map(Quantity::element).collect();
    let frames = Frames::create(path, &elements, rows)?;
    let write = || {
        provenance.write(frames.file())?;
        for quantity in quantities {
            let Some((rows, columns)) = &quantity.table else { continue };
            let group = frames.file().group(&format!("observables/{}", quantity.name))?;
            crate::text::write_attribute(&group, "rows", &rows.join(","))?;
            crate::text::write_attribute(&group, "columns", &columns.join(","))?;
        }
        frames.file().flush()
    };
    write().map_err(|e| FileError::write(path, &e))?;
    Ok(frames)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_go_to_both_files_and_none_is_doubled() {
        let folder = tempfile::tempdir().unwrap();
        let provenance =
            Provenance { scene: "a = 1".into(), program: "test 1".into(), plan: "none".into(), ranks: 1, seed: 2 };
        let quantities =
            [Quantity::number("gap", "length"), Quantity::vectors("mean", "length/time", &["a".into(), "b".into()])];
        let row = |step: u64| vec![vec![step as f64], (0..6).map(|i| 0.1 * f64::from(i) + step as f64).collect()];
        let mut series = Series::create(folder.path(), &provenance, &quantities, 4).unwrap();
        for step in 0..4 {
            series.append((step, 0.1 * step as f64), &row(step)).unwrap();
        }
        drop(series);
        let csv = folder.path().join("observables.csv");
        let whole = std::fs::read_to_string(&csv).unwrap();
        assert!(whole.starts_with("step,time,gap,mean_x[a],mean_y[a],mean_z[a],mean_x[b],mean_y[b],mean_z[b]\n"));
        std::fs::write(&csv, whole.clone() + "4,0.").unwrap(); // cut short
        let mut series = Series::resume(folder.path(), &provenance, &quantities, (1, 9)).unwrap();
        assert_eq!(series.last_step().unwrap(), Some(1));
        for step in 2..4 {
            series.append((step, 0.1 * step as f64), &row(step)).unwrap();
        }
        assert_eq!(std::fs::read_to_string(&csv).unwrap(), whole);
        drop(series);
        let file = hdf5::File::open(folder.path().join("observables.h5")).unwrap();
        let means: Vec<f64> = file.dataset("observables/mean/value").unwrap().read_raw().unwrap();
        assert_eq!(means, (0..4).flat_map(|step| row(step)[1].clone()).collect::<Vec<_>>());
    }
}
