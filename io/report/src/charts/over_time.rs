//! Charts of a time series.

use crate::chart::Chart;
use files::Observables;

/// A chart of quantities that are single numbers, each with the name of its line. `None` if the run has none of them.
pub(super) fn numbers(series: &Observables, title: &str, y: &str, names: &[(&str, &str)]) -> Option<Chart> {
    let unit = names.iter().find_map(|(name, _)| Some(series.get(name)?.unit.clone()))?;
    let mut chart = Chart::new(title, ("time", "time"), (y, &unit));
    for (name, label) in names {
        if let Some((_, points)) = series.line(name) {
            chart.add(label, points, Vec::new());
        }
    }
    Some(chart)
}
