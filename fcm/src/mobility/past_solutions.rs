//! Columns of past solutions, from which the next solve starts.

use domain::ColumnValues;
use gpu::{GUESSED, PAST};

/// Columns of past solutions and weights of their extrapolation: a mix of a line and a parabola in time.
///
/// The columns are stresslets of the far field, velocities and angular velocities that the loads of all other spheres
/// induce, and velocities and angular velocities relative to the background flow.
#[derive(Debug, Clone, PartialEq)]
pub struct PastSolutions {
    /// Values of each column in past solutions, the last ones first; empty lists stand for zeros.
    pub columns: [[ColumnValues; PAST]; GUESSED],
    /// Weights of the solutions in the line.
    pub line: [f64; PAST],
    /// Weights of the solutions in the parabola.
    pub parabola: [f64; PAST],
    /// Weight of the parabola in the mix, for each column.
    pub blend: [f64; GUESSED],
}

impl PastSolutions {
    /// A single solution.
    pub fn last(columns: [ColumnValues; GUESSED]) -> Self {
        let line = [1.0, 0.0, 0.0];
        let columns = columns.map(|values| [(); PAST].map(|()| values.clone()));
        Self { columns, line, parabola: line, blend: [0.0; GUESSED] }
    }

    /// Their numbers, which must be here.
    pub fn numbers(&self) -> PastNumbers<'_> {
        let Self { columns, line, parabola, blend } = self;
        let values = columns.each_ref().map(|column| column.each_ref().map(|values| &values[..]));
        PastNumbers { values, weights: [*line, *parabola], blend: *blend }
    }

    /// Whether there are solutions: all have stresslets of the far field.
    pub fn are_known(&self) -> bool {
        let is_known = |values: &ColumnValues| values.remote_list().is_some() || !values.is_empty();
        self.columns[0].iter().all(is_known)
    }
}

/// Numbers of [`PastSolutions`].
pub struct PastNumbers<'a> {
    values: [[&'a [f64]; PAST]; GUESSED],
    weights: [[f64; PAST]; 2],
    blend: [f64; GUESSED],
}

impl PastNumbers<'_> {
    /// Number of values in the `k`-th column.
    pub fn count(&self, k: usize) -> usize {
        self.values[k][0].len()
    }

    /// The `i`-th value of the `k`-th column by the line, and by the parabola.
    pub fn extrapolated(&self, k: usize, i: usize) -> [f64; 2] {
        let values = &self.values[k];
        self.weights.map(|w| (0..PAST).fold(0.0, |sum, past| sum + w[past] * values[past][i]))
    }

    /// The mix of both.
    pub fn guess(&self, k: usize, i: usize) -> f64 {
        let [line, parabola] = self.extrapolated(k, i);
        line + self.blend[k] * (parabola - line)
    }
}
