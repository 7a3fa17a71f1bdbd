//! Rows of a stencil's box that intersect its ball, and their widths.
//!
//! An envelope depends on the distance alone, so points outside of a ball around the particle are left out. Rows far
//! from the particle are short then, and shorter vectors suffice. All particles use the ball of a particle midway
//! between grid points: the rows are chosen once, and the loops over them have the same lengths for every particle.

use crate::grid::stencil::Support;
use domain::Vector;
use std::f64::consts::PI;
use std::ops::Range;

/// Increment of the width of rows, in columns: half a vector of `f32`, a vector of `f64`.
pub(crate) const STEP: usize = 8;

/// Rows that are processed with one vector at the same columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct GaussianPass {
    /// First column.
    pub column: usize,
    /// Whether half a vector covers the columns.
    pub half: bool,
    /// The rows, plane by plane.
    pub rows: Vec<PassPoint>,
    /// Range that contains the points along y of all rows.
    pub span: Range<usize>,
}

/// A row of the stencil's box: its points along y and z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PassPoint {
    pub y: u32,
    pub z: u32,
}

/// Passes over a stencil in a box of the given strain, with vectors of `lanes` lanes.
pub(crate) fn passes(support: &Support, spacing: Vector, strain: f64, lanes: usize) -> Vec<GaussianPass> {
    let mut passes = Vec::new();
    for (steps, rows) in (Ball { support, spacing, strain }).rows().into_iter().enumerate() {
        if rows.is_empty() {
            continue;
        }
        let width = steps * STEP;
        let (first, last) = (rows.iter().map(|p| p.y).min(), rows.iter().map(|p| p.y).max());
        let span = first.unwrap_or(0) as usize..last.map_or(0, |y| y + 1) as usize;
        for from in (0..width).step_by(lanes) {
            let (column, half) = ((support.lanes - width) / 2 + from, from + lanes > width);
            passes.push(GaussianPass { column, half, rows: rows.clone(), span: span.clone() });
        }
    }
    passes
}

/// Time of the passes over a stencil, in units of a row of one whole vector.
pub(crate) fn length(support: &Support, spacing: Vector, strain: f64, lanes: usize) -> f64 {
    if support.support > COUNTED {
        let radii = Vector::splat(support.reach) / spacing;
        return 4.0 / 3.0 * PI * radii.element_product() / lanes as f64;
    }
    let rows = |pass: &GaussianPass| pass.rows.len() as f64 * if pass.half { OF_HALF } else { 1.0 };
    passes(support, spacing, strain, lanes).iter().map(rows).sum()
}

/// Largest number of points along an axis for which rows are counted; beyond that their number is estimated from the
/// volume.
const COUNTED: usize = 128;

/// Time for half a vector over that for a whole one.
const OF_HALF: f64 = 0.7;

/// Ball of a particle midway between grid points.
struct Ball<'a> {
    support: &'a Support,
    spacing: Vector,
    strain: f64,
}

impl Ball<'_> {
    /// Rows of the ball by the columns that they need, in steps of [`STEP`].
    fn rows(&self) -> Vec<Vec<PassPoint>> {
        let mut rows = vec![Vec::new(); self.support.lanes / STEP + 1];
        let points = 0..self.support.support;
        for (y, z) in points.clone().flat_map(|z| points.clone().map(move |y| (y, z))) {
            rows[self.width(y, z) / STEP].push(PassPoint { y: y as u32, z: z as u32 });
        }
        // Rows without columns are outside the ball.
        rows[0].clear();
        rows
    }

    /// Columns that a row needs: a multiple of [`STEP`], or none.
    fn width(&self, row: usize, plane: usize) -> usize {
        let distance = |point: usize, spacing: f64| (point as f64 + 0.5 - 0.5 * self.support.support as f64) * spacing;
        let (y, z) = (distance(row, self.spacing.y), distance(plane, self.spacing.z));
        let square = self.support.reach.powi(2) - y * y - z * z;
        if square < 0.0 {
            return 0;
        }
        // In a sheared lattice the rows are shifted against each other.
        let half = square.sqrt() + (self.strain * y).abs();
        let columns = (2.0 * half / self.spacing.x - 1e-9).ceil() as usize;
        columns.next_multiple_of(STEP).clamp(STEP, self.support.lanes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of visits of each point of the stencil's box.
    fn visits(support: &Support, strain: f64, lanes: usize) -> Vec<Vec<Vec<usize>>> {
        let mut visits = vec![vec![vec![0; support.lanes]; support.support]; support.support];
        for pass in passes(support, Vector::ONE, strain, lanes) {
            for &PassPoint { y, z } in &pass.rows {
                assert!(pass.span.contains(&(y as usize)));
                for column in pass.column..pass.column + if pass.half { lanes / 2 } else { lanes } {
                    visits[z as usize][y as usize][column] += 1;
                }
            }
        }
        visits
    }

    #[test]
    fn every_point_of_the_ball_is_visited_once() {
        for (points, lanes, strain) in [(5, 16, 0.0), (10, 16, 0.0), (10, 16, 0.5), (17, 8, 0.0), (21, 8, -0.3)] {
            let reach = 0.5 * points as f64;
            let columns = (points as f64 * f64::hypot(1.0, strain)).ceil() as usize;
            let support = Support { lanes: columns.next_multiple_of(STEP), support: points, reach };
            let middle = |count: usize| 0.5 * count as f64 - 0.5;
            for (plane, rows) in visits(&support, strain, lanes).iter().enumerate() {
                for (row, columns) in rows.iter().enumerate() {
                    let (y, z) = (row as f64 - middle(rows.len()), plane as f64 - middle(rows.len()));
                    for (column, &count) in columns.iter().enumerate() {
                        let x = column as f64 - middle(columns.len()) + strain * y;
                        assert!(count <= 1, "{points} points: {count} visits at {column} {row} {plane}");
                        assert!(count == 1 || x * x + y * y + z * z > reach * reach, "left out {x} {y} {z}");
                    }
                }
            }
        }
    }

    #[test]
    fn rows_outside_the_ball_are_not_visited_and_far_ones_are_short() {
        let support = Support { lanes: 16, support: 10, reach: 5.0 };
        let visits = visits(&support, 0.0, 16);
        assert_eq!(visits[0][0].iter().sum::<usize>(), 0);
        assert_eq!(visits[0][5].iter().sum::<usize>(), 8);
        assert_eq!(visits[5][5].iter().sum::<usize>(), 16);
    }
}
