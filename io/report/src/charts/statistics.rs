//! Charts of a suspension's statistics.

use crate::chart::{Chart, ChartLine};
use files::StoredTable;

/// Charts of pairs, velocities, displacements and concentration.
pub(super) fn charts<'a>(table: &dyn Fn(&str) -> Option<&'a StoredTable>) -> Vec<Chart> {
    let charts = [
        table("pairs").and_then(pairs),
        table("velocity_density").and_then(density),
        table("lags").and_then(correlation),
        table("lags").and_then(displacement),
        table("concentration").and_then(concentration),
    ];
    charts.into_iter().flatten().collect()
}

fn pairs(table: &StoredTable) -> Option<Chart> {
    let mut chart = Chart::new("Pair distribution", ("distance of centres", "length"), ("g", "")).with_level(1.0);
    for (of, rows) in table.groups(&["first", "second"]) {
        let name = if of[0] == of[1] { of[0].clone() } else { format!("{} and {}", of[0], of[1]) };
        chart.add(&name, table.points("distance", "g", &rows)?.0, Vec::new());
    }
    Some(chart)
}

fn density(table: &StoredTable) -> Option<Chart> {
    let axes = [("velocity less the mean, over the standard deviation", ""), ("probability density", "")];
    let mut chart = Chart { log: [false, true], ..Chart::new("Velocity distribution", axes[0], axes[1]) };
    let groups = table.groups(&["species", "axis"]);
    let species = first_words(&groups);
    for (of, rows) in &groups {
        let points = table.points("deviations", "density", rows)?.0;
        let axis = ["x", "y", "z"].iter().position(|axis| of[1] == *axis).unwrap_or(0);
        chart.lines.push(line(&species, &of[0], axis, points));
    }
    Some(chart)
}

fn correlation(table: &StoredTable) -> Option<Chart> {
    let axes = [("time lag", "time"), ("correlation over that at once", "")];
    let mut chart = Chart::new("Autocorrelation of the velocity", axes[0], axes[1]).with_level(0.0);
    add_lags(table, "correlation", &mut chart, &|points| {
        let first = points.first().map_or(1.0, |point| point[1]);
        points.iter().map(|[lag, value]| [*lag, value / first]).collect()
    })?;
    Some(chart)
}

fn displacement(table: &StoredTable) -> Option<Chart> {
    let axes = [("time lag", "time"), ("mean square displacement", "length^2")];
    let mut chart = Chart { log: [true, true], ..Chart::new("Displacement", axes[0], axes[1]) };
    add_lags(table, "displacement", &mut chart, &<[[f64; 2]]>::to_vec)?;
    Some(chart)
}

/// Transformation of the points of a line.
type PointTransform = dyn Fn(&[[f64; 2]]) -> Vec<[f64; 2]>;

/// Adds a line for each species and axis.
fn add_lags(table: &StoredTable, name: &str, chart: &mut Chart, of: &PointTransform) -> Option<()> {
    let mut groups = table.groups(&["species"]);
    // The values of all species together are only the mean of the others.
    if groups.len() > 1 {
        groups.retain(|(words, _)| words[0] != "all");
    }
    let species = first_words(&groups);
    for (words, rows) in &groups {
        for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
            let points = of(&table.points("time", &format!("{name}_{letter}"), rows)?.0);
            chart.lines.push(line(&species, &words[0], axis, points));
        }
    }
    Some(())
}

fn concentration(table: &StoredTable) -> Option<Chart> {
    let place = table.number_names().find(|name| *name != "volume_fraction")?;
    let mut chart = Chart::new("Concentration", (place, "length"), ("volume fraction", "")).with_level(0.0);
    for (of, rows) in table.groups(&["species"]) {
        chart.add(&of[0], table.points(place, "volume_fraction", &rows)?.0, Vec::new());
    }
    Some(chart)
}

/// The distinct first words (species) in their order.
fn first_words(groups: &[(Vec<String>, Vec<usize>)]) -> Vec<String> {
    let mut words: Vec<String> = groups.iter().map(|(words, _)| words[0].clone()).collect();
    words.dedup();
    words
}

/// A line of a species along an axis: the species sets the colour and the axis the dashes; with a single species
/// the axis sets the colour.
fn line(species: &[String], name: &str, axis: usize, points: Vec<[f64; 2]>) -> ChartLine {
    let letter = ["x", "y", "z"][axis];
    if species.len() == 1 {
        return ChartLine { name: format!("along {letter}"), points, colour: axis, ..ChartLine::default() };
    }
    let colour = species.iter().position(|other| other == name).unwrap_or(0);
    ChartLine { name: format!("{name}, {letter}"), points, colour, dash: axis, ..ChartLine::default() }
}
