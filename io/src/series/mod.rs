//! Time series of the observables of a run, as CSV for reading and as HDF5 for programs.

mod existing_rows;

use crate::atomic_file;
use crate::frames::{Damage, Element, Frames, Kind, Values};
use crate::scene_history::{self, SceneHistory};
use crate::watched_file::WatchedFile;
use crate::{FileError, Manifest, Provenance};
use existing_rows::ExistingRows;
use simulation::{Quantity, csv_line};
use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A time series that is being written to `observables.csv` and `observables.h5` of a folder.
pub struct Series {
    csv: WatchedFile,
    csv_path: PathBuf,
    frames: Frames,
}

impl Series {
    /// A series of up to `rows` rows in the folder of a run.
    pub fn create(
        run: &Manifest,
        provenance: &Provenance,
        quantities: &[Quantity],
        rows: u64,
    ) -> Result<Self, FileError> {
        let elements: Vec<Element> = quantities.iter().map(element).collect();
        let fixed = |file: &hdf5::File| write_fixed(file, provenance, quantities);
        let kind = Kind { elements: &elements, capacity: rows, fixed: &fixed };
        let path = run.folder().join("observables.h5");
        run.enter(&path)?;
        let frames = Frames::create(&path, &kind)?;
        Self::with_table(run, &header(quantities), frames)
    }

    /// Continues the series of a former run after step `last`: later rows are dropped. `rows` is the number of rows at
    /// the end of the run. The table is written again from the HDF5 file, or that from the table if it, or its end, is missing.
    pub fn resume(
        run: &Manifest,
        provenance: &Provenance,
        quantities: &[Quantity],
        (last, rows): (u64, u64),
    ) -> Result<Self, FileError> {
        let former = ExistingRows::read(&run.folder().join("observables.csv"), quantities, last)?;
        let path = run.folder().join("observables.h5");
        if !path.exists() {
            let mut series = Self::create(run, provenance, quantities, rows)?;
            for (clock, values) in &former.rows {
                series.append(*clock, values)?;
            }
            return Ok(series);
        }
        run.enter(&path)?;
        let elements: Vec<Element> = quantities.iter().map(element).collect();
        let fixed = |file: &hdf5::File| write_fixed(file, provenance, quantities);
        let mut frames = Frames::resume(&path, &Kind { elements: &elements, capacity: rows, fixed: &fixed }, last)?;
        add_rows_of_table(&mut frames, &former)?;
        let table = table(&frames, quantities, &former)?;
        Self::with_table(run, &table, frames)
    }

    fn with_table(run: &Manifest, table: &str, frames: Frames) -> Result<Self, FileError> {
        let csv_path = run.folder().join("observables.csv");
        run.enter(&csv_path)?;
        atomic_file::replace(&csv_path, table.as_bytes())?;
        let csv = for_appending(&csv_path).and_then(|file| WatchedFile::new(&csv_path, file));
        Ok(Self { csv: csv.map_err(|e| FileError::write(&csv_path, &e))?, csv_path, frames })
    }

    /// Notes the changes of the scene.
    pub(crate) fn note_scenes(&mut self, scenes: &SceneHistory) -> Result<(), FileError> {
        self.frames.write(|file| scenes.write(file))
    }

    /// The steps of the rows.
    pub(crate) fn steps(&self) -> Result<Vec<u64>, FileError> {
        self.frames.steps_written()
    }

    /// The step of the last row.
    pub fn last_step(&self) -> Result<Option<u64>, FileError> {
        Ok(self.frames.steps_written()?.last().copied())
    }

    /// The rows of the former run that are not as they were written.
    pub fn damage(&self) -> &[Damage] {
        self.frames.damage()
    }

    /// Adds a row with the numbers of each quantity in turn.
    pub fn append(&mut self, clock: (u64, f64), values: &[Vec<f64>]) -> Result<(), FileError> {
        let line = line(clock, values.iter().flatten());
        self.csv.check()?;
        self.csv.file().write_all(line.as_bytes()).map_err(|e| FileError::write(&self.csv_path, &e))?;
        self.csv.note_growth()?;
        let values: Vec<_> = values.iter().map(|v| v.as_slice().into()).collect();
        self.frames.append(clock, &values)
    }

    /// Waits until all rows so far are on the disk.
    pub fn sync(&self) -> Result<(), FileError> {
        self.csv.check()?;
        atomic_file::sync(self.csv.file()).map_err(|e| FileError::write(&self.csv_path, &e))?;
        self.frames.sync()
    }
}

fn element(quantity: &Quantity) -> Element {
    let shape = quantity.table.as_ref().map(|(rows, columns)| [rows.len(), columns.len()]);
    Element { path: format!("observables/{}", quantity.name), shape, whole: false, unit: quantity.unit }
}

fn header(quantities: &[Quantity]) -> String {
    let mut columns = vec!["step".to_owned(), "time".to_owned()];
    columns.extend(quantities.iter().flat_map(Quantity::columns));
    csv_line(columns.iter().map(String::as_str)) + "\n"
}

fn for_appending(path: &Path) -> std::io::Result<File> {
    OpenOptions::new().append(true).open(path)
}

fn line<'a>((step, time): (u64, f64), values: impl IntoIterator<Item = &'a f64>) -> String {
    let mut line = format!("{step},{time:?}");
    for value in values {
        write!(line, ",{value:?}").expect("text grows");
    }
    line + "\n"
}

fn write_fixed(file: &hdf5::File, provenance: &Provenance, quantities: &[Quantity]) -> hdf5::Result<()> {
    provenance.write(file)?;
    scene_history::create(file)?;
    for quantity in quantities {
        let Some((rows, columns)) = &quantity.table else { continue };
        let group = file.group(&format!("observables/{}", quantity.name))?;
        crate::text::write_attribute(&group, "rows", &csv_line(rows.iter().map(String::as_str)))?;
        crate::text::write_attribute(&group, "columns", &csv_line(columns.iter().map(String::as_str)))?;
    }
    Ok(())
}

/// Adds the rows of the former table that come after those of the HDF5 file, as where an older copy has taken its place.
fn add_rows_of_table(frames: &mut Frames, former: &ExistingRows) -> Result<(), FileError> {
    let last = frames.steps_written()?.last().copied();
    for (clock, values) in former.rows.iter().filter(|(clock, _)| last.is_none_or(|last| clock.0 > last)) {
        let values: Vec<_> = values.iter().map(|v| v.as_slice().into()).collect();
        frames.append(*clock, &values)?;
    }
    Ok(())
}

/// The table of the rows in the HDF5 file. Rows that are damaged there are taken from the former table, if it has them.
fn table(frames: &Frames, quantities: &[Quantity], former: &ExistingRows) -> Result<String, FileError> {
    let mut table = header(quantities);
    for (frame, step) in frames.steps_written()?.into_iter().enumerate() {
        if !frames.damage().iter().any(|damage| damage.frame == frame) {
            let (clock, values) = frames.frame(frame)?;
            table += &line(clock, values.iter().flat_map(Values::reals));
        } else if let Some((clock, values)) = former.rows.iter().find(|(clock, _)| clock.0 == step) {
            table += &line(*clock, values.iter().flatten());
        }
    }
    Ok(table)
}

#[cfg(test)]
mod tests;
