//! Tables of results on a page.

use crate::chart::unit_text;
use crate::html::{folded, table};
use files::StoredTable;

/// The tables of a run that are short enough to be read.
pub(super) fn tables(stored: &[StoredTable]) -> String {
    stored.iter().filter_map(shown).map(|(title, content)| folded(title, &content)).collect()
}

fn shown(stored: &StoredTable) -> Option<(&'static str, String)> {
    let has = |name: &str| stored.numbers(name).is_some();
    match stored.name.as_str() {
        "summary" if has("error") => Some(("Statistics", statistics(stored))),
        "summary" => Some((
            "Solutions",
            columns(stored, &["speed", "pressure", "mean_solid_fraction", "slip", "shear_stress", "residual"]),
        )),
        "family" => {
            let names = ["values", "quantity", "species", "mean", "error", "unit", "seeds", "spread", "claimed_error"];
            Some(("Means over the seeds", columns(stored, &[&names[..], &["calibration", "verdicts"]].concat())))
        }
        "walls" => Some((
            "Stresses on the walls",
            columns(stored, &["wall", "normal", "normal_error", "along", "along_error", "across", "across_error"]),
        )),
        "totals" => Some(("Averages over the cell", totals(stored))),
        "branches" => {
            let names = ["values", "viscous_length", "last_segregation", "last_segregation_error"];
            Some(("Branches of the sweep", columns(stored, &names)))
        }
        _ => None,
    }
}

/// Table of quantities with their errors.
fn statistics(stored: &StoredTable) -> String {
    let bounds = stored.numbers("converged").map_or(&[][..], |(numbers, _)| numbers);
    let row = |row: usize| {
        let cell = |name: &str| stored.cell(name, row);
        let known = stored.numbers("error").is_some_and(|(errors, _)| errors[row] > 0.0 && errors[row].is_finite());
        let least = if bounds.get(row) == Some(&0.0) { " at least" } else { "" };
        let error = if known { format!("\u{b1} {}{least}", cell("error")) } else { String::new() };
        let value = if cell("value") == "NaN" { "unknown".to_owned() } else { cell("value") };
        vec![cell("quantity"), cell("species"), value, error, unit_text(&cell("unit"))]
    };
    let rows: Vec<Vec<String>> = (0..stored.rows()).map(row).collect();
    table(&["quantity", "species", "value", "standard error", "unit"], &rows)
}

/// Table of some columns, with their units.
fn columns(stored: &StoredTable, names: &[&str]) -> String {
    let heads: Vec<String> = names.iter().map(|name| head(stored, name)).collect();
    let rows: Vec<Vec<String>> =
        (0..stored.rows()).map(|row| names.iter().map(|name| stored.cell(name, row)).collect()).collect();
    table(&heads.iter().map(String::as_str).collect::<Vec<_>>(), &rows)
}

/// A table of one row, transposed.
fn totals(stored: &StoredTable) -> String {
    let row = |name: &str| vec![head(stored, name), stored.cell(name, 0)];
    let rows: Vec<Vec<String>> = if stored.rows() == 1 { stored.number_names().map(row).collect() } else { Vec::new() };
    table(&["quantity", "value"], &rows)
}

fn head(stored: &StoredTable, name: &str) -> String {
    let unit = stored.numbers(name).map_or("", |(_, unit)| unit);
    let words = name.replace('_', " ");
    if unit.is_empty() { words } else { format!("{words} ({})", unit_text(unit)) }
}
