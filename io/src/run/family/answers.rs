//! The answers of a run, as its summary has them.

use crate::FileError;
use simulation::csv_words;
use std::path::Path;

/// A quantity of a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Answer {
    pub(super) quantity: String,
    pub(super) species: String,
    pub(super) unit: String,
    pub(super) verdict: String,
    pub(super) value: f64,
    pub(super) error: f64,
}

/// The answers in the folder of a run; none where it has none yet.
pub(super) fn of(folder: &Path) -> Result<Vec<Answer>, FileError> {
    let path = folder.join("summary.csv");
    let Ok(text) = std::fs::read_to_string(&path) else { return Ok(Vec::new()) };
    let mut lines = text.lines().map(csv_words);
    let names = lines.next().unwrap_or_default();
    let place = |name: &str| names.iter().position(|other| other == name);
    let Some((quantity, value)) = place("quantity").zip(place("value")) else { return Ok(Vec::new()) };
    let [species, unit, verdict, error] = ["species", "unit", "verdict", "error"].map(place);
    let answer = |words: Vec<String>| {
        let word = |place: Option<usize>| place.and_then(|place| words.get(place)).cloned().unwrap_or_default();
        let number = |place: Option<usize>| match word(place).as_str() {
            "" => Ok(f64::NAN),
            text => text.parse().map_err(|e| FileError::damaged(&path, &e)),
        };
        Ok(Answer {
            quantity: word(Some(quantity)),
            species: word(species),
            unit: word(unit),
            verdict: word(verdict),
            value: number(Some(value))?,
            error: number(error)?,
        })
    };
    lines.map(answer).collect()
}
