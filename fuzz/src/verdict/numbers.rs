//! Check that the output of the program has no NaN or infinity.

use super::cells::rows;
use hdf5::types::TypeDescriptor;
use hdf5::{Dataset, File, Group};
use std::path::Path;

/// Columns that may be undefined, according to the page on file formats: errors that cannot be estimated, quantities
/// that have not been measured yet or did not occur, a length that does not exist without viscosity, and the spread
/// over a single seed.
const UNDEFINED: [&str; 6] = ["error", "wall_stress", "mean_free_path", "viscous_length", "spread", "calibration"];

/// Columns in which a zero means that a row averages over nothing.
const OF_NOTHING: [&str; 4] = ["converged", "solid_fraction", "disks", "seeds"];

fn may_lack(name: &str) -> bool {
    UNDEFINED.iter().any(|word| name.contains(word))
}

/// Refuses a table with a number that is not finite where one is required.
pub fn of_table(text: &str) -> Result<(), String> {
    let mut rows = rows(text).into_iter();
    let names = rows.next().unwrap_or_default();
    for cells in rows {
        let says_nothing = |(name, cell): (&String, &String)| OF_NOTHING.contains(&name.as_str()) && cell == "0.0";
        if names.iter().zip(&cells).any(says_nothing) {
            continue;
        }
        if let Some((name, cell)) =
            names.iter().zip(&cells).find(|(name, cell)| of_text(cell).is_err() && !may_lack(name))
        {
            return Err(format!("{name} is {cell} in: {}", cells.join(",")));
        }
    }
    Ok(())
}

/// Refuses text with a number that is not finite.
pub fn of_text(text: &str) -> Result<(), String> {
    let is_none = |word: &&str| ["nan", "inf", "infinity", "null"].contains(&word.to_ascii_lowercase().as_str());
    let line = |line: &&str| line.split(|c: char| !c.is_alphanumeric()).any(|word| is_none(&word));
    text.lines()
        .find(line)
        .map_or(Ok(()), |line| Err(format!("no number: {}", &line.chars().take(200).collect::<String>())))
}

/// Refuses an HDF5 file with a number that is not finite where one is required, except in rows over nothing.
pub fn of_hdf5(path: &Path) -> Result<(), String> {
    let unreadable = |error: hdf5::Error| format!("it can't be read: {error}");
    let file = File::open(path).map_err(unreadable)?;
    of_group(&file).map_err(unreadable)?.map_or(Ok(()), Err)
}

/// The first number of a group that is not finite.
fn of_group(group: &Group) -> hdf5::Result<Option<String>> {
    let datasets = group.datasets()?;
    let empty = empty_rows(&datasets)?;
    for dataset in datasets.iter().filter(|dataset| !may_lack(&dataset.name())) {
        if let Some((row, number)) = first_undefined(dataset, &empty)? {
            return Ok(Some(format!("{} is {number} in row {row}", dataset.name())));
        }
    }
    for inner in group.groups()? {
        if let Some(wrong) = of_group(&inner)? {
            return Ok(Some(wrong));
        }
    }
    Ok(None)
}

/// Rows that average over nothing, according to their own columns.
fn empty_rows(datasets: &[Dataset]) -> hdf5::Result<Vec<usize>> {
    let says = |dataset: &&Dataset| OF_NOTHING.iter().any(|name| dataset.name().rsplit('/').next() == Some(name));
    let mut rows = Vec::new();
    for dataset in datasets.iter().filter(says) {
        let numbers = dataset.read_raw::<f64>()?;
        rows.extend(numbers.iter().enumerate().filter(|(_, number)| **number == 0.0).map(|(row, _)| row));
    }
    Ok(rows)
}

fn first_undefined(dataset: &Dataset, empty: &[usize]) -> hdf5::Result<Option<(usize, f64)>> {
    if !matches!(dataset.dtype()?.to_descriptor()?, TypeDescriptor::Float(_)) {
        return Ok(None);
    }
    let numbers = dataset.read_raw::<f64>()?;
    let of_row = numbers.len() / dataset.shape().first().copied().unwrap_or(1).max(1);
    let rows = numbers.iter().enumerate().map(|(place, &number)| (place / of_row.max(1), number));
    Ok(rows.into_iter().find(|(row, number)| !number.is_finite() && !empty.contains(row)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_that_mean_no_number_are_found() {
        assert_eq!(of_text("gap 0.5, information\nnano\n"), Ok(()));
        for text in ["gap NaN\n", "gap -inf\n", "[null]", "a\n1.0, Infinity"] {
            assert!(of_text(text).is_err(), "{text}");
        }
    }

    #[test]
    fn tables_may_lack_what_does_not_exist() {
        assert_eq!(of_table("time,mean_free_path,a_error\n0.0,inf,NaN\n"), Ok(()));
        assert!(of_table("time,gap\n0.0,inf\n").unwrap_err().contains("gap is inf"));
        assert_eq!(of_table("disks,velocity\n0.0,NaN\n"), Ok(()));
        assert!(of_table("disks,velocity\n1.0,NaN\n").is_err());
        assert_eq!(of_table("mean,seeds\nNaN,0.0\n"), Ok(()));
        assert!(of_table("mean,seeds\nNaN,1.0\n").is_err());
        assert_eq!(of_table("point,mean_free_path,gap\n\"a, b\",inf,1.0\n"), Ok(()));
    }

    fn of_columns(columns: &[(&str, [f64; 2])]) -> Result<(), String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        let file = File::create(&path).unwrap();
        let group = file.create_group("table").unwrap();
        for (name, values) in columns {
            group.new_dataset_builder().with_data(values).create(*name).unwrap();
        }
        group.new_dataset_builder().with_data(&[1u32, 2]).create("whole").unwrap();
        file.close().unwrap();
        of_hdf5(&path)
    }

    #[test]
    fn so_do_files_in_hdf5() {
        assert_eq!(of_columns(&[("gap", [0.5, -1e300])]), Ok(()));
        assert_eq!(of_columns(&[("gap", [0.5, f64::INFINITY])]), Err("/table/gap is inf in row 1".to_owned()));
        assert!(of_columns(&[("gap", [f64::NAN, 0.5])]).unwrap_err().contains("row 0"));
        assert_eq!(of_columns(&[("gap_error", [f64::NAN; 2]), ("mean_free_path", [f64::INFINITY; 2])]), Ok(()));
        assert_eq!(of_columns(&[("disks", [0.0, 3.0]), ("velocity", [f64::NAN, 1.0])]), Ok(()));
        assert!(of_columns(&[("disks", [0.0, 3.0]), ("velocity", [1.0, f64::NAN])]).is_err());
        assert!(of_hdf5(Path::new("none.h5")).is_err());
    }
}
