//! Reader of the time series in CSV.

use super::{Observables, Observed};
use crate::FileError;
use simulation::csv_words;
use std::path::Path;

/// Reads the quantities that `names` selects, without their units; incomplete rows, such as the last one of a
/// killed run, are left out.
pub(super) fn read(path: &Path, names: &dyn Fn(&str) -> bool) -> Result<Observables, FileError> {
    let csv = std::fs::read_to_string(path).map_err(|e| FileError::read(path, &e))?;
    let mut lines = csv.split_inclusive('\n');
    let columns = csv_words(lines.next().unwrap_or_default().trim_end());
    if !columns.iter().take(2).eq(["step", "time"]) {
        return Err(FileError::damaged(path, &"its first line does not begin with step,time"));
    }
    let row = |line: &str| -> Option<Vec<f64>> {
        let numbers: Vec<f64> =
            line.strip_suffix('\n')?.split(',').map(|cell| cell.parse().ok()).collect::<Option<_>>()?;
        (numbers.len() == columns.len()).then_some(numbers)
    };
    let rows: Vec<Vec<f64>> = lines.filter_map(row).collect();
    let mut series = Observables { times: rows.iter().map(|row| row[1]).collect(), ..Observables::default() };
    series.last_step = rows.last().map(|row| row[0] as u64);
    for group in grouped(&columns[2..]) {
        if names(&group.name) {
            let places = group.first + 2..group.first + 2 + group.count;
            let values = rows.iter().flat_map(|row| row[places.clone()].iter().copied()).collect();
            let Group { name, rows, columns, .. } = group;
            series.quantities.push(Observed { name, unit: String::new(), rows, columns, values });
        }
    }
    Ok(series)
}

/// Consecutive columns of one quantity.
struct Group {
    name: String,
    rows: Vec<String>,
    columns: Vec<String>,
    first: usize,
    count: usize,
}

/// The quantities with columns named `name` or `name_column[row]`, row by row.
fn grouped(columns: &[String]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (first, column) in columns.iter().enumerate() {
        let Some((name, part, row)) = parts(column) else {
            groups.push(Group { name: column.clone(), rows: Vec::new(), columns: Vec::new(), first, count: 1 });
            continue;
        };
        let Some(last) = groups.last_mut().filter(|last| last.name == name && !last.rows.is_empty()) else {
            let [rows, columns] = [row, part].map(|item| vec![item.to_owned()]);
            groups.push(Group { name: name.to_owned(), rows, columns, first, count: 1 });
            continue;
        };
        last.count += 1;
        for (list, item) in [(&mut last.rows, row), (&mut last.columns, part)] {
            if !list.iter().any(|known| known == item) {
                list.push(item.to_owned());
            }
        }
    }
    groups
}

/// Name, column and row.
fn parts(column: &str) -> Option<(&str, &str, &str)> {
    let (of_column, row) = column.strip_suffix(']')?.split_once('[')?;
    let (name, part) = of_column.rsplit_once('_')?;
    Some((name, part, row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_has_what_the_file_has() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("observables.csv");
        let table = "step,time,mean_velocity_x[a],mean_velocity_y[a],\"mean_velocity_x[b, c]\",\
                     \"mean_velocity_y[b, c]\",smallest_gap\n\
                     0,0.0,1.0,2.0,3.0,4.0,0.5\n1,0.1,5.0,6.0,7.0,NaN,0.25\n2,0.2,1.0,2.0";
        std::fs::write(&path, table).unwrap();
        let read = Observables::of_folder(folder.path(), &|name| name != "unknown").unwrap().unwrap();
        assert_eq!((read.times.as_slice(), read.last_step), (&[0.0, 0.1][..], Some(1)));
        let velocity = read.get("mean_velocity").unwrap();
        assert_eq!((velocity.rows.len(), velocity.columns.len(), velocity.rows[1].as_str()), (2, 2, "b, c"));
        assert_eq!(velocity.column(1, 0).collect::<Vec<_>>(), [3.0, 7.0]);
        assert_eq!(read.get("smallest_gap").unwrap().column(0, 0).collect::<Vec<_>>(), [0.5, 0.25]);
        let none = Observables::of_folder(folder.path(), &|_| false).unwrap().unwrap();
        assert!(none.quantities.is_empty());
        std::fs::write(&path, "a,b\n").unwrap();
        assert!(Observables::of_folder(folder.path(), &|_| true).unwrap_err().to_string().contains("step,time"));
    }
}
