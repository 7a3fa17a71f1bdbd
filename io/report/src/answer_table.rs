//! Answers of a run on its page.

use crate::chart::unit_text;
use crate::html::table;
use crate::{RunAnswer, value_in_words, verdict_in_words};
use domain::Number;

/// Table of the answers; empty if there are none.
pub(super) fn table_of(answers: &[RunAnswer]) -> String {
    if answers.is_empty() {
        return String::new();
    }
    let heads = ["quantity", "species", "value", "unit", "verdict", "effective samples", "mean from time"];
    format!("<h2>Answers</h2>\n{}", table(&heads, &answers.iter().map(row).collect::<Vec<_>>()))
}

fn row(RunAnswer { quantity, species, mean, unit }: &RunAnswer) -> Vec<String> {
    let number = |number: f64, digits: usize| {
        if number.is_finite() { format!("{:.digits$}", Number(number)) } else { String::new() }
    };
    let value = value_in_words(mean).replace("+-", "\u{b1}");
    let [samples, transient] = [number(mean.samples, 2), number(mean.transient, 4)];
    let words = [quantity.replace('_', " "), species.clone(), value, unit_text(unit), verdict_in_words(mean.verdict)];
    words.into_iter().chain([samples, transient]).collect()
}
