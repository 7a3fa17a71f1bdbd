//! Answers of a member: one value with an error for each quantity.

use files::FileError;
use report::{read_answers, verdict_word};
use scene::{Kind, Scene};
use simulation::csv_words;
use std::path::Path;

/// A quantity of a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MemberAnswer {
    pub(super) quantity: String,
    pub(super) species: String,
    pub(super) unit: String,
    pub(super) verdict: String,
    pub(super) value: f64,
    pub(super) error: f64,
}

/// Answers in the folder of a run of a scene; empty if it has none yet.
pub(super) fn of(folder: &Path, scene: &Scene) -> Result<Vec<MemberAnswer>, FileError> {
    if let Kind::Continuum(_) = scene.kind() {
        return of_solutions(&folder.join("summary.csv"));
    }
    let answers = read_answers(folder)?.unwrap_or_default();
    Ok(answers
        .into_iter()
        .map(|answer| MemberAnswer {
            verdict: verdict_word(answer.mean.verdict).to_owned(),
            value: answer.mean.value,
            error: answer.mean.error,
            quantity: answer.quantity,
            species: answer.species,
            unit: answer.unit,
        })
        .collect())
}

/// Columns of the solutions of a continuum, with their units; the first two identify a solution.
const OF_SOLUTIONS: [(&str, &str); 5] = [
    ("speed", "length/time"),
    ("pressure", "force/length^2"),
    ("mean_solid_fraction", ""),
    ("slip", "length/time"),
    ("shear_stress", "force/length^2"),
];

/// Answers from the solutions of a continuum, which have no errors.
fn of_solutions(path: &Path) -> Result<Vec<MemberAnswer>, FileError> {
    let Ok(text) = std::fs::read_to_string(path) else { return Ok(Vec::new()) };
    let mut lines = text.lines().map(csv_words);
    let names = lines.next().unwrap_or_default();
    let mut answers = Vec::new();
    for words in lines {
        let word = |column: usize| {
            let place = names.iter().position(|name| name == OF_SOLUTIONS[column].0);
            place.and_then(|place| words.get(place)).ok_or_else(|| FileError::damaged(path, &"a column is missing"))
        };
        let species = format!("speed {}, pressure {}", word(0)?, word(1)?);
        for (column, (quantity, unit)) in OF_SOLUTIONS.into_iter().enumerate().skip(2) {
            let value = word(column)?.parse().map_err(|e| FileError::damaged(path, &e))?;
            let (quantity, unit) = (quantity.to_owned(), unit.to_owned());
            let (species, verdict) = (species.clone(), "solved".to_owned());
            answers.push(MemberAnswer { quantity, species, unit, verdict, value, error: f64::NAN });
        }
    }
    Ok(answers)
}
