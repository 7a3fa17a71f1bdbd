//! Charts of a family of sheared disks.

use crate::chart::Chart;
use files::StoredTable;

/// Points that a chart shows at most.
const MOST: usize = 7;

/// Segregation over the strain, and what is left of it at the end against the viscous length.
pub(super) fn charts(averages: Option<&StoredTable>, branches: Option<&StoredTable>) -> Vec<Chart> {
    [averages.and_then(over_strain), branches.and_then(at_the_end)].into_iter().flatten().collect()
}

fn over_strain(table: &StoredTable) -> Option<Chart> {
    let mut chart = Chart::new("Segregation over the strain", ("strain", ""), ("segregation", ""));
    for (of, rows) in table.groups(&["values"]).into_iter().take(MOST) {
        let (points, errors) = table.points("strain", "segregation", &rows)?;
        chart.add(&of[0], points, errors);
    }
    Some(chart)
}

fn at_the_end(table: &StoredTable) -> Option<Chart> {
    let axes = [("viscous length", "length"), ("segregation in the last tenth", "")];
    let mut chart = Chart::new("Segregation against the viscous length", axes[0], axes[1]);
    for (of, rows) in table.groups(&["area_fraction"]).into_iter().take(MOST) {
        let (mut points, errors) = table.points("viscous_length", "last_segregation", &rows)?;
        let mut together: Vec<_> = points.drain(..).zip(errors).collect();
        together.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        let (points, errors) = together.into_iter().unzip();
        chart.add(&format!("area fraction {}", of[0]), points, errors);
    }
    Some(chart)
}
