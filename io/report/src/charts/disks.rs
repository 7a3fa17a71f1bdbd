//! Charts of sheared disks.

use super::over_time::numbers;
use crate::chart::Chart;
use files::{Observables, StoredTable};

/// Segregation, energy and stresses over time, and profiles over the height.
pub(super) fn charts(series: &Observables, profile: Option<&StoredTable>) -> Vec<Chart> {
    if series.get("kinetic_energy").is_none() {
        return Vec::new();
    }
    let stresses = [("stress_xx", "xx"), ("stress_xy", "xy"), ("stress_yy", "yy")];
    let over_time = [
        numbers(series, "Segregation of large and small disks", "segregation", &[("segregation", "")]),
        numbers(series, "Kinetic energy", "energy", &[("kinetic_energy", "")]),
        numbers(series, "Stress of collisions", "stress", &stresses),
        numbers(series, "Mean free path", "path", &[("mean_free_path", "")]),
    ];
    let profiles = profile.into_iter().flat_map(|table| {
        [
            over_height(table, "Velocity over the height", "velocity", "velocity along x"),
            over_height(table, "Granular temperature over the height", "temperature", "temperature"),
        ]
    });
    over_time.into_iter().chain(profiles).flatten().collect()
}

fn over_height(table: &StoredTable, title: &str, column: &str, name: &str) -> Option<Chart> {
    let rows: Vec<usize> = (0..table.rows()).collect();
    let (points, errors) = table.points("height", column, &rows)?;
    let mut chart = Chart::new(title, ("height", "length"), (name, table.numbers(column)?.1));
    chart.add("", points, errors);
    Some(chart)
}
