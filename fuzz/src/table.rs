//! Edits of text tables: cells and lines.

use crate::hostile;
use proptest::prelude::*;
use proptest::sample::Index;

/// An edit.
#[derive(Debug, Clone)]
pub enum TableEdit {
    /// Replaces the text of a cell.
    Cell(Index, Index, String),
    /// Removes a line.
    Remove(Index),
    /// Copies a line to another position.
    Copy(Index, Index),
    /// Doubles or removes a separator.
    Separator(Index, Index, bool),
}

/// One to four edits.
pub fn edits() -> impl Strategy<Value = Vec<TableEdit>> {
    let index = any::<Index>;
    let cell = prop_oneof![
        3 => hostile::number().prop_map(|number| number.to_string()),
        2 => hostile::whole().prop_map(|number| number.to_string()),
        2 => hostile::word(),
        1 => Just("Properties=species:I:1:pos:R:18446744073709551615:radius:R:1".to_owned()),
    ];
    prop::collection::vec(
        prop_oneof![
            5 => (index(), index(), cell).prop_map(|(line, cell, text)| TableEdit::Cell(line, cell, text)),
            1 => index().prop_map(TableEdit::Remove),
            1 => (index(), index()).prop_map(|(from, to)| TableEdit::Copy(from, to)),
            1 => (index(), index(), any::<bool>()).prop_map(|(line, at, twice)| TableEdit::Separator(line, at, twice)),
        ],
        1..5,
    )
}

/// Applies an edit to a table with this separator of cells.
pub fn apply(text: &str, separator: char, edit: &TableEdit) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    if lines.is_empty() {
        return String::new();
    }
    let count = lines.len();
    match edit {
        TableEdit::Cell(line, cell, new) => {
            let line = &mut lines[line.index(count)];
            let mut cells: Vec<&str> = line.split(separator).collect();
            let at = cell.index(cells.len());
            cells[at] = new;
            *line = cells.join(&separator.to_string());
        }
        TableEdit::Remove(line) => drop(lines.remove(line.index(count))),
        TableEdit::Copy(from, to) => lines.insert(to.index(count), lines[from.index(count)].clone()),
        TableEdit::Separator(line, at, twice) => {
            let line = &mut lines[line.index(count)];
            let places: Vec<usize> = line.match_indices(separator).map(|(place, _)| place).collect();
            match (places.is_empty(), twice) {
                (true, _) => line.push(separator),
                (false, true) => line.insert(places[at.index(places.len())], separator),
                (false, false) => drop(line.remove(places[at.index(places.len())])),
            }
        }
    }
    lines.join("\n") + "\n"
}
