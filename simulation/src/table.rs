//! Tables of results.

use crate::csv::{csv_cell, csv_line};
use domain::Bytes;
use serde_json::Value;
use std::fmt::Write as _;

/// A table: columns of words that label each row, and columns of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name in files.
    pub name: &'static str,
    /// Names of the columns of words.
    pub labels: &'static [&'static str],
    /// Names and units of the columns of numbers.
    pub columns: Vec<(String, &'static str)>,
    /// Words and numbers of each row.
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
        let mut csv = csv_line(self.labels.iter().copied().chain(self.columns.iter().map(|c| c.0.as_str()))) + "\n";
        for (words, numbers) in &self.rows {
            let words = words.iter().map(|word| csv_cell(word));
            let cells: Vec<String> = words.chain(numbers.iter().map(|number| format!("{number:?}"))).collect();
            writeln!(csv, "{}", cells.join(",")).expect("text grows");
        }
        csv
    }

    /// The rows as JSON: an object with all columns for each. Numbers that are not finite are null.
    pub fn to_json(&self) -> Value {
        let row = |(words, numbers): &(Vec<String>, Vec<f64>)| {
            let words = self.labels.iter().zip(words).map(|(&name, word)| (name.to_owned(), word.as_str().into()));
            let numbers = self.columns.iter().zip(numbers).map(|((name, _), &number)| (name.clone(), number.into()));
            Value::Object(words.chain(numbers).collect())
        };
        self.rows.iter().map(row).collect()
    }

    /// Memory of a table with `rows` rows of numbers, each an allocation of its own, and of its text.
    pub fn bytes(rows: f64, columns: usize) -> Bytes {
        let numbers = Bytes::list::<f64>((columns + 1) as f64 * rows);
        let text = Bytes::keep(rows * columns as f64 * CHARACTERS);
        Bytes::list::<(Vec<String>, Vec<f64>)>(rows).then(numbers).then(text.freed())
    }
}

/// Average number of characters of a number in CSV.
const CHARACTERS: f64 = 16.0;

/// Tables that are written together.
#[derive(Debug, Clone, PartialEq)]
pub struct TableSet {
    /// Folder within the results; `None` for the folder of the results itself.
    pub folder: Option<&'static str>,
    /// Name of the file that contains all of them.
    pub name: &'static str,
    /// The tables.
    pub tables: Vec<Table>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn rows_are_objects_in_json_and_lines_in_csv() {
        let mut table = Table::new("summary", &["quantity"], &[("value", "length"), ("error", "length")]);
        table.add(&["a, \"b\""], &[0.5, f64::NAN]);
        assert_eq!(table.to_json(), json!([{"quantity": "a, \"b\"", "value": 0.5, "error": null}]));
        assert_eq!(table.to_csv(), "quantity,value,error\n\"a, \"\"b\"\"\",0.5,NaN\n");
    }
}
