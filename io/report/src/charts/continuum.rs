//! Charts of the kinetic theory of a shear cell.

use crate::chart::Chart;
use domain::Number;
use files::StoredTable;

/// Largest number of solutions in a chart.
const MOST: usize = 6;

/// Profiles over the gap, for each speed and pressure.
pub(super) fn charts(profile: Option<&StoredTable>) -> Vec<Chart> {
    let Some(table) = profile.filter(|table| table.numbers("energy_flux").is_some()) else { return Vec::new() };
    let over_gap = |title: &str, column: &str, name: &str| over_gap(table, title, column, name);
    let charts = [
        over_gap("Velocity across the gap", "velocity", "velocity"),
        over_gap("Solid fraction across the gap", "solid_fraction", "solid fraction"),
        over_gap("Granular temperature across the gap", "temperature", "temperature"),
    ];
    charts.into_iter().flatten().collect()
}

fn over_gap(table: &StoredTable, title: &str, column: &str, name: &str) -> Option<Chart> {
    let mut chart = Chart::new(title, ("height y", "length"), (name, table.numbers(column)?.1));
    let (speeds, pressures) = (table.numbers("speed")?.0, table.numbers("pressure")?.0);
    for (_, rows) in table.groups(&["speed", "pressure"]).into_iter().take(MOST) {
        let (speed, pressure) = (Number(speeds[rows[0]]), Number(pressures[rows[0]]));
        let (points, errors) = table.points("y", column, &rows)?;
        chart.add(&format!("speed {speed:.3}, pressure {pressure:.3}"), points, errors);
    }
    Some(chart)
}
