//! Particles sorted into cells, to find who is near.

use crate::{PeriodicBox, Vector};
use std::ops::Range;

/// Cells along each axis, in lattice coordinates, and the particles sorted into them.
pub(crate) struct Cells {
    counts: [usize; 3],
    starts: Vec<u32>,
    rows: Vec<u32>,
    /// The particles' positions in the order of the cells, by component.
    positions: [Vec<f64>; 3],
    reach: [i32; 3],
}

/// Particles, or images of them, in consecutive cells.
pub(crate) struct Run<'a> {
    /// Their rows.
    rows: &'a [u32],
    positions: [&'a [f64]; 3],
    /// What to add to their positions, and the lattice steps of that.
    shift: Vector,
    /// Lattice steps to the images.
    pub steps: [i8; 3],
}

/// Particles in a cube of the cutoff's edge above which halved cells find neighbours faster: they leave out more of those
/// that are not, but are more numerous.
const CROWDED: f64 = 12.0;

impl Run<'_> {
    /// Appends the rows of those within a distance of `centre`, but not the particle `itself`.
    pub fn append_near(&self, (centre, itself): (Vector, u32), distance: f64, near: &mut Vec<u32>) {
        let [x, y, z] = self.positions;
        let from = centre - self.shift;
        let count = near.len();
        near.resize(count + self.rows.len(), 0);
        let mut found = count;
        // Its images are others.
        let itself = if self.steps == [0; 3] { itself } else { u32::MAX };
        for (i, &row) in self.rows.iter().enumerate() {
            let (dx, dy, dz) = (x[i] - from.x, y[i] - from.y, z[i] - from.z);
            // Without a branch, which would be mispredicted all the time.
            near[found] = row;
            let is_near = usize::from(dx * dx + dy * dy + dz * dz < distance * distance);
            found += is_near * usize::from(row != itself);
        }
        near.truncate(found);
    }
}

impl Cells {
    /// Cells about as wide as the cutoff, or half of it where they would be crowded, and the particles in each.
    pub fn sort(cell: &PeriodicBox, positions: &[Vector], cutoff: f64) -> Self {
        let edges = cell.edges();
        let crowd = positions.len() as f64 * cutoff.powi(3) / (edges.x * edges.y * edges.z);
        let fineness = if crowd > CROWDED { 2.0 } else { 1.0 };
        // Within a distance d, the first lattice coordinate differs by up to d sqrt(1 + s^2).
        let widest = Vector::new(cutoff * (1.0 + cell.strain().powi(2)).sqrt(), cutoff, cutoff);
        let most = (positions.len() as f64).cbrt().ceil().max(1.0);
        let counts = (edges / widest * fineness).floor().clamp(Vector::ONE, Vector::splat(2.0 * most));
        let reach = (widest / edges * counts).ceil().to_array().map(|r| r as i32);
        let counts = counts.to_array().map(|c| c as usize);
        let places: Vec<usize> = positions.iter().map(|&p| place(cell, counts, p)).collect();
        let mut starts = vec![0_u32; counts.iter().product::<usize>() + 1];
        for &c in &places {
            starts[c + 1] += 1;
        }
        for c in 1..starts.len() {
            starts[c] += starts[c - 1];
        }
        let mut next = starts.clone();
        let mut rows = vec![0; positions.len()];
        for (row, &c) in places.iter().enumerate() {
            rows[next[c] as usize] = row as u32;
            next[c] += 1;
        }
        let component = |axis: usize| rows.iter().map(|&row: &u32| positions[row as usize][axis]).collect();
        let positions = [component(0), component(1), component(2)];
        Self { counts, starts, rows, positions, reach }
    }

    /// Visits the particles, and the images of them by lattice steps, in the cells that the cutoff around a position
    /// may touch.
    pub fn for_each_run(&self, cell: &PeriodicBox, position: Vector, mut visit: impl FnMut(Run)) {
        let home = coordinates(cell, self.counts, position).map(|c| c as i32);
        let counts = self.counts.map(|c| c as i32);
        let around = |axis: usize| {
            (home[axis] - self.reach[axis]..=home[axis] + self.reach[axis])
                .map(move |c| (c.rem_euclid(counts[axis]), c.div_euclid(counts[axis])))
        };
        let (first, last) = (home[0] - self.reach[0], home[0] + self.reach[0]);
        for (z, up) in around(2) {
            for (y, back) in around(1) {
                let line = (z * counts[1] + y) * counts[0];
                for right in first.div_euclid(counts[0])..=last.div_euclid(counts[0]) {
                    let from = line + (first - right * counts[0]).max(0);
                    let to = line + (last - right * counts[0]).min(counts[0] - 1) + 1;
                    visit(self.run(cell, from as usize..to as usize, [right, back, up]));
                }
            }
        }
    }

    fn run(&self, cell: &PeriodicBox, cells: Range<usize>, steps: [i32; 3]) -> Run<'_> {
        let range = self.starts[cells.start] as usize..self.starts[cells.end] as usize;
        let shift = if steps == [0; 3] { Vector::ZERO } else { cell.lattice(steps) };
        let [x, y, z] = &self.positions;
        let positions = [&x[range.clone()], &y[range.clone()], &z[range.clone()]];
        Run { rows: &self.rows[range], positions, shift, steps: steps.map(|s| s as i8) }
    }
}

fn coordinates(cell: &PeriodicBox, counts: [usize; 3], position: Vector) -> [usize; 3] {
    let fractions = (cell.lattice_coordinates(position) / cell.edges()).to_array();
    std::array::from_fn(|d| ((fractions[d] * counts[d] as f64).max(0.0) as usize).min(counts[d] - 1))
}

fn place(cell: &PeriodicBox, counts: [usize; 3], position: Vector) -> usize {
    let [x, y, z] = coordinates(cell, counts, position);
    (z * counts[1] + y) * counts[0] + x
}
