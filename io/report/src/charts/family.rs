//! Charts of a family: each quantity over the first swept key with numbers, with errors from the spread over seeds.

use crate::chart::Chart;
use files::StoredTable;
use scene::Family;

/// Largest number of charts, and of lines of a chart.
const MOST_CHARTS: usize = 24;
const MOST_LINES: usize = 7;
/// An axis whose values have a larger ratio is logarithmic.
const WIDE: f64 = 30.0;

/// A chart for each quantity.
pub(super) fn charts(family: Option<&Family>, table: Option<&StoredTable>) -> Vec<Chart> {
    let Some((family, table)) = family.zip(table) else { return Vec::new() };
    let Some(index) = family.keys().iter().position(|key| table.numbers(key).is_some()) else { return Vec::new() };
    let groups = table.groups(&["quantity"]);
    groups
        .into_iter()
        .take(MOST_CHARTS)
        .filter_map(|(name, rows)| chart(SweptKey { family, index }, table, &name[0], &rows))
        .collect()
}

/// A swept key of a family, by its index.
#[derive(Clone, Copy)]
struct SweptKey<'a> {
    family: &'a Family,
    index: usize,
}

fn chart(SweptKey { family, index }: SweptKey, table: &StoredTable, quantity: &str, rows: &[usize]) -> Option<Chart> {
    let key = &family.keys()[index];
    let (x, [mean, errors]) = (table.numbers(key)?.0, ["mean", "error"].map(|name| table.numbers(name)));
    let (mean, errors) = (mean?.0, errors?.0);
    let title = quantity.replace('_', " ");
    let mut chart = Chart::new(&title, (key, ""), ("mean over the seeds", &table.cell("unit", rows[0])));
    let mut lines: Vec<(String, Vec<usize>)> = Vec::new();
    for &row in rows {
        let name = name(family, index, [&table.cell("point", row), &table.cell("species", row)]);
        match lines.iter_mut().find(|(other, _)| *other == name) {
            Some((_, rows)) => rows.push(row),
            None => lines.push((name, vec![row])),
        }
    }
    for (name, mut rows) in lines.into_iter().take(MOST_LINES) {
        rows.sort_by(|a, b| x[*a].total_cmp(&x[*b]));
        let points = rows.iter().map(|&row| [x[row], mean[row]]).collect();
        chart.add(&name, points, rows.iter().map(|&row| errors[row]).collect());
    }
    let [least, most] = [f64::min, f64::max].map(|pick| rows.iter().map(|&row| x[row]).reduce(pick).unwrap_or(0.0));
    chart.log[0] = least > 0.0 && most > WIDE * least;
    Some(chart)
}

/// Name of a line: the species, and the values of the other swept keys.
fn name(family: &Family, place: usize, [point, species]: [&str; 2]) -> String {
    let member = family.members().iter().find(|member| member.point_name() == point);
    let others = member.map(|member| member.described_but(place)).unwrap_or_default();
    let species = if species == "all" { "" } else { species };
    [species, &others].into_iter().filter(|words| !words.is_empty()).collect::<Vec<_>>().join(", ")
}
