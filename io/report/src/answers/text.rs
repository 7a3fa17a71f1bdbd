//! Answers for people and for programs to read.

use super::table::verdict_word;
use super::{REDUCED, RunAnswer};
use domain::Number;
use serde_json::{Value, json};
use statistics::{SteadyMean, Verdict};

/// Lines of the table after a run.
const MOST: usize = 12;

/// The first answers as a table for reading: quantity, species, value with its error to two digits, unit and verdict.
/// Those in other units, `reduced_...`, are left to the file.
pub fn answers_in_lines(answers: &[RunAnswer]) -> String {
    let answers: Vec<&RunAnswer> = answers.iter().filter(|answer| !answer.quantity.starts_with(REDUCED)).collect();
    let shown = if answers.len() > MOST { MOST - 1 } else { answers.len() };
    let rows: Vec<[String; 5]> = answers[..shown].iter().map(|answer| cells(answer)).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths = [0, 1, 2, 3].map(width);
    let line = |row: &[String; 5]| {
        let cells = row.iter().zip(widths).filter(|(_, width)| *width > 0);
        let padded: Vec<String> = cells.map(|(cell, width)| format!("{cell:<width$}")).collect();
        format!("{}  {}\n", padded.join("  "), row[4])
    };
    let more = match answers.len() - shown {
        0 => String::new(),
        left => format!("and {left} more in summary.csv\n"),
    };
    rows.iter().map(line).collect::<String>() + &more
}

fn cells(answer: &RunAnswer) -> [String; 5] {
    let species = if answer.species == super::ALL { String::new() } else { answer.species.clone() };
    let value = value_in_words(&answer.mean);
    [answer.quantity.replace('_', " "), species, value, answer.unit.clone(), verdict_in_words(answer.mean.verdict)]
}

/// A value with its error to two digits, such as `14.69 +- 0.35`.
pub fn value_in_words(mean: &SteadyMean) -> String {
    let SteadyMean { value, error, .. } = *mean;
    if !value.is_finite() {
        return "-".to_owned();
    }
    if error == 0.0 || !error.is_finite() {
        return format!("{:.6}", Number(value));
    }
    let place = |number: f64| number.abs().log10().floor() as i32;
    // The error rounded to two digits may have one more before the point.
    let last = place(format!("{error:.1e}").parse().unwrap_or(error)) - 1;
    let largest = place(value.abs().max(error));
    if (-4..6).contains(&largest) && last <= 2 {
        let decimals = usize::try_from(-last).unwrap_or(0);
        return format!("{value:.decimals$} +- {error:.decimals$}");
    }
    let (unit, decimals) = (10.0_f64.powi(largest), usize::try_from(largest - last).unwrap_or(0));
    format!("({:.decimals$} +- {:.decimals$})e{largest}", value / unit, error / unit)
}

/// A verdict in words.
pub fn verdict_in_words(verdict: Verdict) -> String {
    match verdict {
        Verdict::Converged => "converged".to_owned(),
        Verdict::TooShort { longer } => format!("too short: {:.2} times longer", Number(longer.max(1.1))),
        Verdict::Drifting => "still drifting".to_owned(),
        Verdict::Meaningless => "too short for any value".to_owned(),
    }
}

/// All answers as JSON: an object for each, with null where there is no number.
pub fn answers_in_json(answers: &[RunAnswer]) -> Value {
    let object = |RunAnswer { quantity, species, mean, unit }: &RunAnswer| {
        let SteadyMean { value, error, samples, transient, verdict } = mean;
        let longer = if let Verdict::TooShort { longer } = verdict { Some(longer) } else { None };
        json!({
            "quantity": quantity,
            "species": species,
            "value": value,
            "error": error,
            "samples": samples,
            "transient": transient,
            "verdict": verdict_word(*verdict),
            "longer": longer,
            "unit": unit,
        })
    };
    answers.iter().map(object).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(value: f64, error: f64, verdict: Verdict) -> SteadyMean {
        SteadyMean { value, error, samples: 12.0, transient: 0.5, verdict }
    }

    #[test]
    fn errors_have_two_digits() {
        for (value, error, expected) in [
            (14.686, 0.3451, "14.69 +- 0.35"),
            (-0.012_346, 0.000_99, "-0.01235 +- 0.00099"),
            (121.4, 99.9, "121 +- 100"),
            (121.4, 3.04, "121.4 +- 3.0"),
            (1.2345e-9, 1.2e-11, "(1.234 +- 0.012)e-9"),
            (2.5e9, 1.3e8, "(2.50 +- 0.13)e9"),
            (1.0, 250.0, "1 +- 250"),
            (0.5, 0.0, "0.5"),
            (f64::NAN, f64::NAN, "-"),
        ] {
            assert_eq!(value_in_words(&mean(value, error, Verdict::Converged)), expected);
        }
    }

    #[test]
    fn the_table_is_aligned_and_short() {
        let answer = |quantity: &str, species: &str, mean, unit: &str| RunAnswer {
            quantity: quantity.into(),
            species: species.into(),
            mean,
            unit: unit.into(),
        };
        let answers = [
            answer("relative_viscosity", "all", mean(14.686, 0.3451, Verdict::TooShort { longer: 3.71 }), ""),
            answer("height", "heavy", mean(f64::NAN, f64::NAN, Verdict::Meaningless), "length"),
        ];
        let expected = "relative viscosity         14.69 +- 0.35          too short: 3.7 times longer\n\
                        height              heavy  -              length  too short for any value\n";
        assert_eq!(answers_in_lines(&answers), expected);
        let many = vec![answers[0].clone(); 20];
        let text = answers_in_lines(&many);
        assert!(text.lines().count() == 12 && text.ends_with("and 9 more in summary.csv\n"), "{text}");
        let json = answers_in_json(&answers);
        assert_eq!((&json[0]["longer"], &json[1]["value"]), (&json!(3.71), &Value::Null));
        assert_eq!((&json[0]["verdict"], &json[1]["longer"]), (&json!("too short"), &Value::Null));
    }
}
