//! Charts of a shear cell.

use crate::chart::Chart;
use files::{Observables, StoredTable};

/// Stresses on the walls over time, and profiles over the height.
pub(super) fn charts(series: &Observables, profile: Option<&StoredTable>) -> Vec<Chart> {
    let Some(stress) = series.get("wall_stress") else { return Vec::new() };
    let on_walls = stress.columns.iter().take(2).enumerate().map(|(column, name)| {
        let title = format!("Stress on the walls: {name}");
        let mut chart = Chart::new(&title, ("time", "time"), ("stress", &stress.unit)).with_level(0.0);
        for (row, wall) in stress.rows.iter().enumerate() {
            chart.add(wall, series.over_time(stress.column(row, column)), Vec::new());
        }
        Some(chart)
    });
    let profiles = profile.into_iter().flat_map(|table| {
        [
            over_height(table, "Solid fraction over the height", "solid_fraction", "solid fraction"),
            over_height(table, "Velocity over the height", "velocity_x", "velocity along x"),
            over_height(table, "Granular temperature over the height", "temperature", "temperature"),
        ]
    });
    on_walls.chain(profiles).flatten().collect()
}

fn over_height(table: &StoredTable, title: &str, column: &str, name: &str) -> Option<Chart> {
    let rows: Vec<usize> = (0..table.rows()).collect();
    let (points, errors) = table.points("y", column, &rows)?;
    let mut chart = Chart::new(title, ("height y", "length"), (name, table.numbers(column)?.1)).with_level(0.0);
    chart.add("", points, errors);
    Some(chart)
}
