//! Tables of results, as CSV for people and as HDF5 for programs.

use crate::{FileError, Manifest, Provenance, atomic_file, atomic_hdf5, text};
use hdf5::File;
use hdf5::types::VarLenUnicode;
use simulation::{Table, csv_line};
use std::path::Path;

/// Rows of a CSV file with the columns of a table without words.
pub fn read_rows(table: &Table, path: &Path) -> Result<Vec<Vec<f64>>, FileError> {
    let csv = std::fs::read_to_string(path).map_err(|e| FileError::read(path, &e))?;
    let mut lines = csv.lines();
    let expected = table.columns.iter().map(|(name, _)| name.as_str());
    let expected = csv_line(expected);
    if lines.next() != Some(&expected) {
        return Err(FileError::damaged(path, &format!("its first line is not {expected}")));
    }
    let row = |line: &str| line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>();
    let rows: Vec<Vec<f64>> = lines.map(row).collect::<Result<_, _>>().map_err(|e| FileError::damaged(path, &e))?;
    match rows.iter().find(|row| row.len() != table.columns.len()) {
        Some(row) => Err(FileError::damaged(path, &format!("it has a row of {} numbers", row.len()))),
        None => Ok(rows),
    }
}

fn write(table: &Table, file: &File) -> hdf5::Result<()> {
    let group = file.create_group(table.name)?;
    for (place, name) in table.labels.iter().enumerate() {
        let words: Vec<VarLenUnicode> = table.rows.iter().map(|(words, _)| text::scalar(&words[place])).collect();
        group.new_dataset_builder().with_data(&words).create(*name)?;
    }
    for (place, (name, unit)) in table.columns.iter().enumerate() {
        let numbers: Vec<f64> = table.rows.iter().map(|(_, numbers)| numbers[place]).collect();
        let dataset = group.new_dataset_builder().with_data(&numbers).create(name.as_str())?;
        text::write_dimensions(&dataset, unit)?;
    }
    Ok(())
}

/// Writes tables to a folder, which is created: each as a separate CSV file, and all together as `NAME.h5`. Existing
/// files of those names are replaced if the manifest lists them or is not that of the folder.
pub fn write_tables(
    folder: &Path,
    name: &str,
    provenance: &Provenance,
    tables: &[Table],
    manifest: &Manifest,
) -> Result<(), FileError> {
    if folder != manifest.folder() {
        manifest.make_folder(folder)?;
    }
    let enter = |name: &str, extension: &str| {
        let path = folder.join(name).with_extension(extension);
        manifest.enter(&path).map(|()| path)
    };
    for table in tables {
        atomic_file::replace(&enter(table.name, "csv")?, table.to_csv().as_bytes())?;
    }
    atomic_hdf5::write(&enter(name, "h5")?, |file| {
        provenance.write(file)?;
        tables.iter().try_for_each(|table| write(table, file))
    })
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
            let none = Manifest::none(folder.path());
            write_tables(folder.path(), "all", &provenance, &[table.clone()], &none).unwrap();
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
        assert_eq!(read_rows(&table, &path).unwrap(), [[1.0 / 3.0, -1e-300], [f64::INFINITY, 0.0]]);
        let other = Table::new("sizes", &[], &[("length", "length")]);
        let error = read_rows(&other, &path).unwrap_err().to_string();
        assert!(error.contains("sizes.csv is damaged: its first line is not length"), "{error}");
        std::fs::write(&path, "length,share\n1.0\n").unwrap();
        assert!(read_rows(&table, &path).unwrap_err().to_string().contains("it has a row of 1 numbers"));
    }
}
