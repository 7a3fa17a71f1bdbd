//! Quantities of a time series.

use std::borrow::Cow;

/// A quantity of a time series: a number, or a table of numbers such as a vector for each species.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Name of the quantity.
    pub name: Cow<'static, str>,
    /// Unit, in terms of length, time and force.
    pub unit: &'static str,
    /// Names of the rows and columns, if it is a table.
    pub table: Option<(Vec<String>, Vec<String>)>,
}

impl Quantity {
    /// A quantity that is one number.
    pub fn number(name: &'static str, unit: &'static str) -> Self {
        Self { name: name.into(), unit, table: None }
    }

    /// A vector for each species.
    pub fn vectors(name: &'static str, unit: &'static str, species: &[String]) -> Self {
        Self { name: name.into(), unit, table: Some((species.to_vec(), ["x", "y", "z"].map(String::from).to_vec())) }
    }

    /// Names of its numbers as columns of a table, each `name` or `name_column[row]`.
    pub fn columns(&self) -> Vec<String> {
        let Some((rows, columns)) = &self.table else { return vec![self.name.clone().into_owned()] };
        rows.iter().flat_map(|row| columns.iter().map(move |column| format!("{}_{column}[{row}]", self.name))).collect()
    }
}
