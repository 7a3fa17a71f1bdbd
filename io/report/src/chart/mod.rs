//! Charts as SVG: lines over an axis, with units and a legend.

mod axis;
mod svg;
#[cfg(test)]
mod tests;
mod thin;

pub(super) use svg::svg;

/// Lines over an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chart {
    /// Title.
    pub(super) title: String,
    /// Titles of the axes.
    pub(super) axes: [AxisTitle; 2],
    /// Whether each axis is logarithmic.
    pub(super) log: [bool; 2],
    /// A value that the vertical axis always includes, marked by a thin line.
    pub(super) level: Option<f64>,
    /// The lines.
    pub(super) lines: Vec<ChartLine>,
}

/// Quantity and unit of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AxisTitle {
    pub(super) quantity: String,
    pub(super) unit: String,
}

/// A line of a chart.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct ChartLine {
    /// Name in the legend; a chart with a single line without a name has no legend.
    pub(super) name: String,
    /// Points; the line is broken at those that are not finite.
    pub(super) points: Vec<[f64; 2]>,
    /// Standard errors of the points; empty, or one per point.
    pub(super) errors: Vec<f64>,
    /// Index of the colour.
    pub(super) colour: usize,
    /// Index of the dash pattern.
    pub(super) dash: usize,
}

impl Chart {
    /// A chart without lines, on linear axes.
    pub(super) fn new(title: &str, x: (&str, &str), y: (&str, &str)) -> Self {
        let axes = [x, y].map(|(name, unit)| AxisTitle { quantity: name.to_owned(), unit: unit.to_owned() });
        Self { title: title.to_owned(), axes, log: [false; 2], level: None, lines: Vec::new() }
    }

    /// The same chart with a thin line at a value, which the vertical axis always includes.
    pub(super) fn with_level(self, level: f64) -> Self {
        Self { level: Some(level), ..self }
    }

    /// Adds a line in a new colour.
    pub(super) fn add(&mut self, name: &str, points: Vec<[f64; 2]>, errors: Vec<f64>) {
        let colour = self.lines.len();
        self.lines.push(ChartLine { name: name.to_owned(), points, errors, colour, dash: 0 });
    }
}

/// A unit as readable text.
pub(super) fn unit_text(unit: &str) -> String {
    unit.replace("^2", "\u{b2}").replace("^3", "\u{b3}").replace('*', " ")
}
