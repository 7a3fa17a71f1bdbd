//! Rows of a time series written by an earlier part of the run.

use super::header;
use crate::FileError;
use simulation::Quantity;
use std::path::Path;

/// The complete rows of an existing table up to a step.
#[derive(Default)]
pub(super) struct ExistingRows {
    /// Rows whose numbers can all be read, in their order.
    pub(super) rows: Vec<SeriesRow>,
}

/// Step, time, and the numbers of each quantity in turn.
pub(super) type SeriesRow = ((u64, f64), Vec<Vec<f64>>);

impl ExistingRows {
    /// Reads the table, if there is one.
    pub(super) fn read(path: &Path, quantities: &[Quantity], last: u64) -> Result<Self, FileError> {
        if !path.exists() {
            return Ok(Self::default());
        }
        let bytes = std::fs::read(path).map_err(|e| FileError::read(path, &e))?;
        let text = String::from_utf8_lossy(&bytes);
        let Some(rows) = text.strip_prefix(&header(quantities)) else { return Ok(Self::default()) };
        let whole = rows.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
        let rows = whole.filter_map(|line| row(line, quantities)).filter(|(clock, _)| clock.0 <= last).collect();
        Ok(Self { rows })
    }
}

fn row(line: &str, quantities: &[Quantity]) -> Option<SeriesRow> {
    let mut words = line.split(',');
    let clock = (words.next()?.parse().ok()?, words.next()?.parse().ok()?);
    let mut number = || words.next()?.parse().ok();
    let mut values =
        |quantity: &Quantity| (0..quantity.columns().len()).map(|_| number()).collect::<Option<Vec<f64>>>();
    let values = quantities.iter().map(&mut values).collect::<Option<Vec<_>>>()?;
    words.next().is_none().then_some((clock, values))
}
