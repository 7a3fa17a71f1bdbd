//! Summary of a simulation and forecast of its cost, as printed by `check`.

use serde_json::{Map, Value};
use std::fmt::{Display, Formatter, Write as _};

/// Summary of a simulation before it is run: readable lines, the same as named values for a program, and warnings.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outline {
    lines: String,
    values: Map<String, Value>,
    warnings: Vec<String>,
    refusal: Option<String>,
}

impl Outline {
    /// Adds a line with a label of at most ten letters.
    #[must_use]
    pub fn line(mut self, label: &str, text: impl Display) -> Self {
        writeln!(self.lines, "{label:<10} {text}").expect("text grows");
        self
    }

    /// Adds lines that already have labels.
    #[must_use]
    pub fn lines(mut self, lines: &str) -> Self {
        self.lines += lines;
        self
    }

    /// Adds a value; a number that is not finite is null.
    #[must_use]
    pub fn value(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.values.insert(name.to_owned(), value.into());
        self
    }

    /// Adds warnings for the user before the run.
    #[must_use]
    pub fn warnings(mut self, warnings: impl IntoIterator<Item = String>) -> Self {
        self.warnings.extend(warnings);
        self
    }

    /// Adds the reason why the run would be refused on this machine, if there is one.
    #[must_use]
    pub fn refusal(mut self, reason: Option<String>) -> Self {
        self.refusal = self.refusal.or(reason);
        self
    }

    /// Reason why the run would be refused on this machine, if there is one.
    pub fn refused(&self) -> Option<&str> {
        self.refusal.as_deref()
    }

    /// Lines, without warnings.
    pub fn text(&self) -> &str {
        &self.lines
    }

    /// Values and the list of `warnings`.
    pub fn to_json(&self) -> Value {
        let mut values = self.values.clone();
        values.insert("warnings".to_owned(), self.warnings.clone().into());
        values.into()
    }
}

impl Display for Outline {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.lines)?;
        self.warnings.iter().try_for_each(|warning| writeln!(f, "warning: {warning}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn readers_and_programs_are_told_the_same() {
        let outline = Outline::default()
            .line("particles", format_args!("{}, alone", 1))
            .value("particles", 1)
            .value("smallest_gap", f64::INFINITY)
            .lines("steps      5\n")
            .value("steps", 5)
            .warnings(["it is late".to_owned()]);
        assert_eq!(outline.to_string(), "particles  1, alone\nsteps      5\nwarning: it is late\n");
        let values = json!({"particles": 1, "smallest_gap": null, "steps": 5, "warnings": ["it is late"]});
        assert_eq!(outline.to_json(), values);
    }
}
