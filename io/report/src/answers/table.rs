//! The file of the answers of a run.

use files::{ANSWERS, FileError, Manifest, replace_file};
use simulation::{csv_line, csv_words};
use statistics::{SteadyMean, Verdict};
use std::path::{Path, PathBuf};

/// Columns of the file, as [`files::ANSWERS_START`] has them.
const COLUMNS: [&str; 9] =
    ["quantity", "species", "value", "error", "samples", "transient", "verdict", "longer", "unit"];

/// Answer of a run for one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct RunAnswer {
    /// The quantity.
    pub quantity: String,
    /// The species that it is of; `all` where it is of the whole suspension.
    pub species: String,
    /// Its mean in the steady state.
    pub mean: SteadyMean,
    /// Its unit, in terms of length, time and force.
    pub unit: String,
}

/// Writes the answers of a run into its folder.
pub fn write_answers(answers: &[RunAnswer], manifest: &Manifest) -> Result<PathBuf, FileError> {
    let path = manifest.folder().join(ANSWERS);
    manifest.enter(&path)?;
    let header = csv_line(COLUMNS) + "\n";
    let table: String = std::iter::once(header).chain(answers.iter().map(RunAnswer::line)).collect();
    replace_file(&path, table.as_bytes())?;
    Ok(path)
}

/// The answers in the folder of a run; nothing if it has none.
pub fn read_answers(folder: &Path) -> Result<Option<Vec<RunAnswer>>, FileError> {
    let path = folder.join(ANSWERS);
    if !path.is_file() {
        return Ok(None);
    }
    let csv = std::fs::read_to_string(&path).map_err(|e| FileError::read(&path, &e))?;
    let mut records = records(&csv).into_iter();
    // That of a continuum has the same name.
    if records.next().is_none_or(|header| csv_words(header) != COLUMNS) {
        return Ok(None);
    }
    let read = |record: &str| {
        RunAnswer::of(record).ok_or_else(|| FileError::damaged(&path, &format!("`{record}` is no answer")))
    };
    records.map(read).collect::<Result<_, _>>().map(Some)
}

/// The lines of CSV; those within quotes are part of a cell.
fn records(csv: &str) -> Vec<&str> {
    let (mut records, mut start, mut is_quoted) = (Vec::new(), 0, false);
    for (place, character) in csv.char_indices() {
        match character {
            '"' => is_quoted = !is_quoted,
            '\n' if !is_quoted => {
                records.push(csv[start..place].trim_end_matches('\r'));
                start = place + 1;
            }
            _ => {}
        }
    }
    records.extend((start < csv.len()).then(|| &csv[start..]));
    records
}

impl RunAnswer {
    fn line(&self) -> String {
        let SteadyMean { value, error, samples, transient, verdict } = self.mean;
        let longer = if let Verdict::TooShort { longer } = verdict { longer } else { f64::NAN };
        let [value, error, samples, transient, longer] = [value, error, samples, transient, longer].map(cell);
        let cells = [
            &self.quantity,
            &self.species,
            &value,
            &error,
            &samples,
            &transient,
            verdict_word(verdict),
            &longer,
            &self.unit,
        ];
        csv_line(cells) + "\n"
    }

    fn of(record: &str) -> Option<Self> {
        let words: [String; COLUMNS.len()] = csv_words(record).try_into().ok()?;
        let [quantity, species, value, error, samples, transient, verdict, longer, unit] = words;
        let verdict = match verdict.as_str() {
            "converged" => Verdict::Converged,
            "too short" => Verdict::TooShort { longer: number(&longer)? },
            "drifting" => Verdict::Drifting,
            "meaningless" => Verdict::Meaningless,
            _ => return None,
        };
        let (value, error) = (number(&value)?, number(&error)?);
        let (samples, transient) = (number(&samples)?, number(&transient)?);
        Some(Self { quantity, species, mean: SteadyMean { value, error, samples, transient, verdict }, unit })
    }
}

/// A verdict in the file.
pub fn verdict_word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Converged => "converged",
        Verdict::TooShort { .. } => "too short",
        Verdict::Drifting => "drifting",
        Verdict::Meaningless => "meaningless",
    }
}

/// A number; nothing where there is none.
fn cell(number: f64) -> String {
    if number.is_nan() { String::new() } else { format!("{number:?}") }
}

fn number(cell: &str) -> Option<f64> {
    if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(species: &str, verdict: Verdict) -> RunAnswer {
        let mean = SteadyMean { value: 1.0 / 3.0, error: 2.5e-3, samples: 40.5, transient: 1.0, verdict };
        RunAnswer { quantity: "relative_viscosity".into(), species: species.into(), mean, unit: String::new() }
    }

    #[test]
    fn answers_come_back_from_their_file() {
        let folder = tempfile::tempdir().unwrap();
        assert!(read_answers(folder.path()).unwrap().is_none());
        let answers = [
            answer("all", Verdict::Converged),
            answer("silica, \"2 um\"\nnew", Verdict::TooShort { longer: 4.25 }),
            answer("all", Verdict::Drifting),
        ];
        let manifest = Manifest::begin(folder.path(), "", None).unwrap();
        let path = write_answers(&answers, &manifest).unwrap();
        assert_eq!(read_answers(folder.path()).unwrap().unwrap(), answers);
        assert!(manifest.lists(&path));
        assert_eq!(csv_line(COLUMNS) + "\n", files::ANSWERS_START);
        write_answers(&answers[..1], &manifest).unwrap();
        let csv = std::fs::read_to_string(path).unwrap();
        assert_eq!(
            csv.lines().nth(1).unwrap(),
            "relative_viscosity,all,0.3333333333333333,0.0025,40.5,1.0,converged,,"
        );
    }

    #[test]
    fn no_number_is_written_where_there_is_no_answer() {
        let folder = tempfile::tempdir().unwrap();
        let mut none = answer("all", Verdict::Meaningless);
        none.mean = SteadyMean { value: f64::NAN, error: f64::NAN, samples: f64::NAN, ..none.mean };
        let path = write_answers(&[none], &Manifest::none(folder.path())).unwrap();
        assert!(std::fs::read_to_string(path).unwrap().ends_with("relative_viscosity,all,,,,1.0,meaningless,,\n"));
        let read = read_answers(folder.path()).unwrap().unwrap();
        assert!(read[0].mean.value.is_nan() && read[0].mean.verdict == Verdict::Meaningless);
    }

    #[test]
    fn other_tables_are_no_answers_and_damaged_ones_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(ANSWERS);
        std::fs::write(&path, "speed,pressure\n1,2\n").unwrap();
        assert!(read_answers(folder.path()).unwrap().is_none());
        std::fs::write(&path, csv_line(COLUMNS) + "\na,b,x,1,1,1,converged,,\n").unwrap();
        let error = read_answers(folder.path()).unwrap_err().to_string();
        assert!(error.contains("summary.csv is damaged: `a,b,x,1,1,1,converged,,` is no answer"), "{error}");
    }
}
