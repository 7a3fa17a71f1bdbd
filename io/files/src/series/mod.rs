//! Time series of the observables of a run, as CSV for people and as HDF5 for programs.

mod existing_rows;

use crate::atomic_file;
use crate::frames::{Damage, Element, FileKind, Frames, Values};
use crate::origin::Origin;
use crate::scene_history::SceneHistory;
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
    rows: SeriesFile,
}

/// The HDF5 file.
struct SeriesFile {
    frames: Frames,
    description: SeriesDescription,
}

/// Description of a new HDF5 file of the series.
struct SeriesDescription {
    elements: Vec<Element>,
    quantities: Vec<Quantity>,
    /// Number of rows at the end of the run.
    planned: u64,
    origin: Origin,
}

impl Series {
    /// A series in the folder of a run with this number of rows.
    pub fn create(
        run: &Manifest,
        provenance: &Provenance,
        quantities: &[Quantity],
        rows: u64,
    ) -> Result<Self, FileError> {
        let description = SeriesDescription::new(provenance, quantities, rows);
        let path = run.folder().join("observables.h5");
        run.enter(&path)?;
        let frames = description.with_kind(|kind| Frames::create(&path, kind))?;
        Self::with_table(run, &header(quantities), SeriesFile { frames, description })
    }

    /// Continues the series of an earlier part of the run after step `last`: later rows are dropped. `rows` is the
    /// number of rows at the end of the run. The table is rewritten from the HDF5 file. An HDF5
    /// file that is missing or incomplete is restored from the table.
    pub fn resume(
        run: &Manifest,
        provenance: &Provenance,
        quantities: &[Quantity],
        last: u64,
        rows: u64,
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
        let description = SeriesDescription::new(provenance, quantities, rows);
        let frames = description.with_kind(|kind| Frames::resume(&path, kind, last))?;
        let mut rows = SeriesFile { frames, description };
        rows.add_those_of_table(&former)?;
        let table = table(&rows.frames, quantities, &former)?;
        Self::with_table(run, &table, rows)
    }

    fn with_table(run: &Manifest, table: &str, rows: SeriesFile) -> Result<Self, FileError> {
        let csv_path = run.folder().join("observables.csv");
        run.enter(&csv_path)?;
        atomic_file::replace(&csv_path, table.as_bytes())?;
        let csv = for_appending(&csv_path).and_then(|file| WatchedFile::new(&csv_path, file));
        Ok(Self { csv: csv.map_err(|e| FileError::write(&csv_path, &e))?, csv_path, rows })
    }

    /// Records the changes of the scene.
    pub fn note_scenes(&mut self, scenes: &SceneHistory) -> Result<(), FileError> {
        self.rows.description.origin.note_scenes(scenes, &mut self.rows.frames)
    }

    /// Steps of the rows.
    pub fn steps(&self) -> Result<Vec<u64>, FileError> {
        self.rows.frames.steps_written()
    }

    /// Step of the last row.
    pub fn last_step(&self) -> Result<Option<u64>, FileError> {
        Ok(self.rows.frames.steps_written()?.last().copied())
    }

    /// Damaged rows of the earlier part of the run.
    pub fn damage(&self) -> &[Damage] {
        self.rows.frames.damage()
    }

    /// Appends a row with the numbers of each quantity in turn.
    pub fn append(&mut self, clock: (u64, f64), values: &[Vec<f64>]) -> Result<(), FileError> {
        let line = line(clock.0, clock.1, values.iter().flatten());
        self.csv.check()?;
        self.csv.file().write_all(line.as_bytes()).map_err(|e| FileError::write(&self.csv_path, &e))?;
        self.csv.note_growth()?;
        self.rows.append(clock, values)
    }

    /// Waits until all rows so far are on the disk.
    pub fn sync(&self) -> Result<(), FileError> {
        self.csv.check()?;
        atomic_file::sync(self.csv.file()).map_err(|e| FileError::write(&self.csv_path, &e))?;
        self.rows.frames.sync()
    }
}

impl SeriesFile {
    fn append(&mut self, clock: (u64, f64), values: &[Vec<f64>]) -> Result<(), FileError> {
        let values: Vec<_> = values.iter().map(|v| v.as_slice().into()).collect();
        self.description.with_kind(|kind| self.frames.append(kind, clock, &values))
    }

    /// Appends rows of the existing table after the last of the HDF5 file, as needed if an older
    /// copy has replaced that file.
    fn add_those_of_table(&mut self, former: &ExistingRows) -> Result<(), FileError> {
        let last = self.frames.steps_written()?.last().copied();
        let later = former.rows.iter().filter(|(clock, _)| last.is_none_or(|last| clock.0 > last));
        later.into_iter().try_for_each(|(clock, values)| self.append(*clock, values))
    }
}

impl SeriesDescription {
    fn new(provenance: &Provenance, quantities: &[Quantity], planned: u64) -> Self {
        let elements = quantities.iter().map(element).collect();
        Self { elements, quantities: quantities.to_vec(), planned, origin: Origin::new(provenance) }
    }

    fn with_kind<R>(&self, with: impl FnOnce(&FileKind) -> R) -> R {
        let fixed = |file: &hdf5::File| {
            self.origin.write(file)?;
            self.write_names(file)
        };
        with(&FileKind { elements: &self.elements, planned: self.planned, fixed: &fixed })
    }

    /// Writes the names of rows and columns.
    fn write_names(&self, file: &hdf5::File) -> hdf5::Result<()> {
        for quantity in &self.quantities {
            let Some((rows, columns)) = &quantity.table else { continue };
            let group = file.group(&format!("observables/{}", quantity.name))?;
            crate::text::write_attribute(&group, "rows", &csv_line(rows.iter().map(String::as_str)))?;
            crate::text::write_attribute(&group, "columns", &csv_line(columns.iter().map(String::as_str)))?;
        }
        Ok(())
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

fn line<'a>(step: u64, time: f64, values: impl IntoIterator<Item = &'a f64>) -> String {
    let mut line = format!("{step},{time:?}");
    for value in values {
        write!(line, ",{value:?}").expect("text grows");
    }
    line + "\n"
}

/// Table of the rows in the HDF5 file. Damaged rows are taken from the existing table, if it has them.
fn table(frames: &Frames, quantities: &[Quantity], former: &ExistingRows) -> Result<String, FileError> {
    let mut table = header(quantities);
    for (frame, step) in frames.steps_written()?.into_iter().enumerate() {
        if !frames.damage().iter().any(|damage| damage.frame == frame) {
            let (clock, values) = frames.frame(frame)?;
            table += &line(clock.0, clock.1, values.iter().flat_map(Values::reals));
        } else if let Some((clock, values)) = former.rows.iter().find(|(clock, _)| clock.0 == step) {
            table += &line(clock.0, clock.1, values.iter().flatten());
        }
    }
    Ok(table)
}

#[cfg(test)]
mod tests;
