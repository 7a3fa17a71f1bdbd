//! Drawing of a chart as SVG.

use super::axis::{ChartAxis, power_of_ten};
use super::thin::thinned;
use super::{AxisTitle, Chart, ChartLine, unit_text};
use crate::html::escaped;
use std::fmt::Write as _;

/// Width and height of the picture.
const SIZE: [f64; 2] = [520.0, 330.0];
/// Margins of the plot area: left, right and below.
const MARGINS: [f64; 3] = [66.0, 16.0, 50.0];
/// Lower end of the plot area.
const BOTTOM: f64 = SIZE[1] - MARGINS[2];
/// Height of a row of the legend.
const ROW: f64 = 18.0;
/// Approximate width of a letter.
const LETTER: f64 = 6.6;
/// Colours that are distinguishable with colour vision deficiency (Okabe & Ito).
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555"];
const DASHES: [&str; 4] = ["", "6 3", "2 3", "8 3 2 3"];
/// Lines with up to this number of points have markers.
const MARKED: usize = 24;

/// Plot area and its axes.
struct Area {
    x: ChartAxis,
    y: ChartAxis,
    top: f64,
}

/// Draws a chart. `None` if there is nothing to draw: no line has a point that its axes can show.
pub(crate) fn svg(chart: &Chart) -> Option<String> {
    let entries = legend(chart);
    let rows = entries.last().map_or(0.0, |(_, [_, row])| row + 1.0);
    let points = || chart.lines.iter().flat_map(|line| &line.points);
    let shown = || points().filter(|[x, y]| x.is_finite() && y.is_finite());
    let x = ChartAxis::of(shown().map(|point| point[0]), chart.log[0])?;
    let y = ChartAxis::of(shown().map(|point| point[1]).chain(bars(chart)).chain(chart.level), chart.log[1])?;
    let area = Area { x, y, top: 14.0 + ROW * rows };
    let (title, [width, height]) = (escaped(&chart.title), SIZE);
    let mut svg = format!("<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}\">\n");
    svg += &area.frame(chart);
    for (line, place) in entries {
        svg += &entry(line, place);
    }
    for line in &chart.lines {
        svg += &area.line(line);
    }
    Some(svg + "</svg>\n")
}

/// Label of an axis: its name, and in brackets the unit, with the power of ten that the labels omit.
fn named(axis: &ChartAxis, AxisTitle { quantity, unit }: &AxisTitle) -> String {
    let power = if axis.power == 0 { String::new() } else { power_of_ten(axis.power) };
    let is_said = quantity == unit;
    let unit = [power, if is_said { String::new() } else { unit_text(unit) }].join(" ");
    let unit = unit.trim();
    escaped(&if unit.is_empty() { quantity.clone() } else { format!("{quantity} ({unit})") })
}

/// Ends of the error bars.
fn bars(chart: &Chart) -> impl Iterator<Item = f64> {
    let bar = |(point, error): (&[f64; 2], &f64)| [point[1] - error, point[1] + error];
    chart.lines.iter().flat_map(move |line| line.points.iter().zip(&line.errors).flat_map(bar))
}

/// Lines with a legend entry, each with its position: letters from the left, and row.
fn legend(chart: &Chart) -> Vec<(&ChartLine, [f64; 2])> {
    let room = SIZE[0] - MARGINS[0] - MARGINS[1];
    let (mut entries, mut place) = (Vec::new(), [0.0, 0.0]);
    for line in chart.lines.iter().filter(|line| !line.name.is_empty()) {
        let width = 42.0 + LETTER * line.name.chars().count() as f64;
        if place[0] > 0.0 && place[0] + width > room {
            place = [0.0, place[1] + 1.0];
        }
        entries.push((line, place));
        place[0] += width;
    }
    entries
}

fn entry(line: &ChartLine, [across, row]: [f64; 2]) -> String {
    let (x, y) = (MARGINS[0] + across, 12.0 + ROW * row);
    let (end, words, baseline, style) = (x + 22.0, x + 27.0, y + 4.0, style(line));
    format!(
        "<path d=\"M{x:.1} {y:.1}H{end:.1}\" {style}/><text x=\"{words:.1}\" y=\"{baseline:.1}\">{}</text>\n",
        escaped(&line.name)
    )
}

fn style(line: &ChartLine) -> String {
    let (colour, dash) = (COLOURS[line.colour % COLOURS.len()], DASHES[line.dash % DASHES.len()]);
    format!("class=\"line\" stroke=\"{colour}\" stroke-dasharray=\"{dash}\"")
}

/// Horizontal position of a fraction of the plot area's width.
fn across(part: f64) -> f64 {
    MARGINS[0] + part * (SIZE[0] - MARGINS[0] - MARGINS[1])
}

impl Area {
    /// Position of a point on the picture, if the axes can show it.
    fn place(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        Some([across(self.x.place(x)?), self.up(self.y.place(y)?)])
    }

    fn up(&self, part: f64) -> f64 {
        BOTTOM - part * (BOTTOM - self.top)
    }

    /// Axes, ticks, their labels and the names of the axes.
    fn frame(&self, chart: &Chart) -> String {
        let [left, right, bottom, top] = [across(0.0), across(1.0), BOTTOM, self.top];
        let mut svg = String::new();
        for (part, label) in self.x.ticks() {
            let (x, end, words) = (across(part), bottom + 5.0, bottom + 19.0);
            write!(
                svg,
                "<path class=\"grid\" d=\"M{x:.1} {top:.1}V{bottom:.1}\"/><path class=\"axis\" d=\"M{x:.1} \
                {bottom:.1}V{end:.1}\"/>"
            )
            .expect("text grows");
            writeln!(svg, "<text class=\"x\" x=\"{x:.1}\" y=\"{words:.1}\">{label}</text>").expect("text grows");
        }
        for (part, label) in self.y.ticks() {
            let (y, end, words) = (self.up(part), left - 5.0, left - 8.0);
            write!(
                svg,
                "<path class=\"grid\" d=\"M{left:.1} {y:.1}H{right:.1}\"/><path class=\"axis\" d=\"M{end:.1} \
                {y:.1}H{left:.1}\"/>"
            )
            .expect("text grows");
            writeln!(svg, "<text class=\"y\" x=\"{words:.1}\" y=\"{:.1}\">{label}</text>", y + 4.0)
                .expect("text grows");
        }
        if let Some(y) = chart.level.and_then(|level| self.y.place(level)).map(|part| self.up(part)) {
            writeln!(svg, "<path class=\"level\" d=\"M{left:.1} {y:.1}H{right:.1}\"/>").expect("text grows");
        }
        svg + &format!("<path class=\"axis\" d=\"M{left:.1} {top:.1}V{bottom:.1}H{right:.1}\"/>\n") + &self.names(chart)
    }

    fn names(&self, chart: &Chart) -> String {
        let [x, y] = [(&self.x, &chart.axes[0]), (&self.y, &chart.axes[1])].map(|(axis, name)| named(axis, name));
        let (middle, height) = (across(0.5), self.up(0.5));
        format!(
            "<text class=\"x\" x=\"{middle:.1}\" y=\"{:.1}\">{x}</text>\
             <text class=\"x\" transform=\"translate(15 {height:.1}) rotate(-90)\">{y}</text>\n",
            SIZE[1] - 10.0
        )
    }

    /// The line where it is finite, with markers if there are few points, and error bars.
    fn line(&self, line: &ChartLine) -> String {
        let (mut path, mut pen, mut marks) = (String::new(), 'M', String::new());
        for place in thinned(&line.points).into_iter().map(|point| self.place(point)) {
            let Some([x, y]) = place else {
                pen = 'M';
                continue;
            };
            write!(path, "{pen}{x:.1} {y:.1}").expect("text grows");
            pen = 'L';
            if line.points.len() <= MARKED {
                write!(
                    marks,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\" fill=\"{}\"/>",
                    COLOURS[line.colour % COLOURS.len()]
                )
                .expect("text grows");
            }
        }
        let bars: String =
            line.points.iter().zip(&line.errors).filter_map(|(point, error)| self.bar(*point, *error)).collect();
        let (style, plain) = (style(line), style(&ChartLine { dash: 0, ..line.clone() }));
        let bars = if bars.is_empty() { bars } else { format!("<path d=\"{bars}\" {plain}/>") };
        format!("<path d=\"{path}\" {style}/>{bars}{marks}\n")
    }

    fn bar(&self, [x, y]: [f64; 2], error: f64) -> Option<String> {
        let ([x, low], [_, high]) = (self.place([x, y - error])?, self.place([x, y + error])?);
        (error > 0.0).then(|| format!("M{x:.1} {low:.1}V{high:.1}"))
    }
}
