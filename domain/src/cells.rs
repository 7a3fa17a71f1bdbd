//! Cell lists: particles sorted into cells, for the neighbour search.

use crate::neighbour::Images;
use crate::parallel::{FusedLoops, SortedRows, mapped};
use crate::{PeriodicBox, Vector};
use std::ops::Range;

/// Cells along each axis, in lattice coordinates, and the particles sorted into them.
pub(crate) struct Cells {
    counts: [usize; 3],
    sorted: SortedRows,
    /// Positions of the particles in the order of the cells, by component.
    positions: [Vec<f64>; 3],
    reach: [i32; 3],
    images: Images,
}

/// The particle around which candidates are searched.
#[derive(Clone, Copy)]
pub(crate) struct Centre {
    pub position: Vector,
    pub row: u32,
}

/// Particles, and their periodic images, in and around one cell: the candidates for neighbours of that cell's
/// particles.
#[derive(Default)]
pub(crate) struct CellNeighbourhood {
    /// Entries as in the lists of neighbours.
    who: Vec<u32>,
    positions: [Vec<f64>; 3],
    is_near: Vec<bool>,
    found: Vec<u32>,
}

impl CellNeighbourhood {
    /// Calls `visit` with the row and the separation of each candidate that is within a distance of `centre` and has
    /// a larger row than it, so that each pair is visited once.
    pub fn each_later(
        &mut self,
        Cells { images, .. }: &Cells,
        centre: Centre,
        distance: f64,
        mut visit: impl FnMut(u32, Vector),
    ) {
        self.mark_near(centre.position, distance);
        self.found.resize(self.who.len(), 0);
        let mut found = 0;
        for (place, (&who, &is_near)) in self.who.iter().zip(&self.is_near).enumerate() {
            // Without a branch, which would often be mispredicted.
            self.found[found] = place as u32;
            found += usize::from(is_near) * usize::from(images.row(who) > centre.row);
        }
        for place in self.found[..found].iter().map(|&place| place as usize) {
            let [x, y, z] = &self.positions;
            visit(images.row(self.who[place]), Vector::new(x[place], y[place], z[place]) - centre.position);
        }
    }

    /// Appends the candidates within a distance of `centre`, except the particle at the centre itself.
    pub fn append_near(&mut self, cells: &Cells, centre: Centre, distance: f64, near: &mut Vec<u32>) {
        self.mark_near(centre.position, distance);
        let itself = cells.images.entry(centre.row);
        let mut found = near.len();
        near.resize(found + self.who.len(), itself);
        for (&who, &is_near) in self.who.iter().zip(&self.is_near) {
            // Without a branch, which would often be mispredicted.
            near[found] = who;
            found += usize::from(is_near) * usize::from(who != itself);
        }
        near.truncate(found);
    }

    /// Marks the candidates within a distance of `centre`.
    fn mark_near(&mut self, centre: Vector, distance: f64) {
        let [x, y, z] = &self.positions;
        self.is_near.clear();
        self.is_near.extend(x.iter().zip(y).zip(z).map(|((x, y), z)| {
            let (dx, dy, dz) = (x - centre.x, y - centre.y, z - centre.z);
            dx * dx + dy * dy + dz * dz < distance * distance
        }));
    }
}

/// Number of particles in a cube as wide as the cutoff above which cells of half the width are faster: there are more
/// of them, but they exclude more of the particles beyond the cutoff.
const CROWDED_CELL: f64 = 12.0;

impl Cells {
    /// Sorts particles into cells about as wide as the cutoff, or half as wide if such cells would hold many
    /// particles.
    pub fn sort(cell: &PeriodicBox, positions: &[Vector], cutoff: f64) -> Self {
        Self::sort_among(cell, positions, cutoff, positions.len())
    }

    /// The same for particles in a part of the box, which has `total` particles.
    pub fn sort_among(cell: &PeriodicBox, positions: &[Vector], cutoff: f64, total: usize) -> Self {
        let (edges, images) = (cell.edges(), Images::new(cell, cutoff));
        images.check_rows(positions.len());
        let expected = total as f64 * cutoff.powi(3) / (edges.x * edges.y * edges.z);
        let fineness = if expected > CROWDED_CELL { 2.0 } else { 1.0 };
        let widest = cell.coordinate_stretch() * cutoff;
        let most = (positions.len() as f64).cbrt().ceil().max(1.0);
        let counts = (edges / widest * fineness).floor().clamp(Vector::ONE, Vector::splat(2.0 * most));
        let reach = (widest / edges * counts).ceil().to_array().map(|r| r as i32);
        let counts = counts.to_array().map(|c| c as usize);
        let places = mapped(positions, |&position| place(cell, counts, position) as u32);
        let sorted = SortedRows::by_key(&places, counts.iter().product());
        let mut components = [const { Vec::new() }; 3];
        let mut loops = FusedLoops::default();
        for (axis, component) in components.iter_mut().enumerate() {
            loops.mapped(component, sorted.rows(), move |&row| positions[row as usize][axis]);
        }
        loops.run();
        Self { counts, sorted, positions: components, reach, images }
    }

    /// Images to which entries refer.
    pub fn images(&self) -> &Images {
        &self.images
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.sorted.starts().len() - 1
    }

    /// Rows of the particles in a cell.
    pub fn members(&self, cell: usize) -> &[u32] {
        self.sorted.of(cell)
    }

    /// Places of the particles in consecutive cells.
    fn places(&self, cells: Range<usize>) -> Range<usize> {
        let starts = self.sorted.starts();
        starts[cells.start] as usize..starts[cells.end] as usize
    }

    /// Collects the particles and images in all cells that are within the cutoff of a cell.
    pub fn collect_around(&self, cell: &PeriodicBox, home: usize, around: &mut CellNeighbourhood) {
        around.who.clear();
        around.positions.iter_mut().for_each(Vec::clear);
        let [nx, ny, _] = self.counts;
        let home = [home % nx, home / nx % ny, home / (nx * ny)].map(|c| c as i32);
        let counts = self.counts.map(|c| c as i32);
        let ends = |axis: usize| {
            let (first, last) = (home[axis] - self.reach[axis], home[axis] + self.reach[axis]);
            if cell.is_periodic(axis) { (first, last) } else { (first.max(0), last.min(counts[axis] - 1)) }
        };
        let range = |axis: usize| {
            let (first, last) = ends(axis);
            (first..=last).map(move |c| (c.rem_euclid(counts[axis]), c.div_euclid(counts[axis])))
        };
        let (first, last) = ends(0);
        for (z, up) in range(2) {
            for (y, back) in range(1) {
                let line = (z * counts[1] + y) * counts[0];
                for right in first.div_euclid(counts[0])..=last.div_euclid(counts[0]) {
                    let from = line + (first - right * counts[0]).max(0);
                    let to = line + (last - right * counts[0]).min(counts[0] - 1) + 1;
                    self.append(cell, from as usize..to as usize, [right, back, up], around);
                }
            }
        }
    }

    /// Appends the images of the particles in consecutive cells.
    fn append(&self, cell: &PeriodicBox, cells: Range<usize>, steps: [i32; 3], around: &mut CellNeighbourhood) {
        let range = self.places(cells);
        let shift = if steps == [0; 3] { Vector::ZERO } else { cell.lattice(steps) };
        let image = self.images.entry(0).wrapping_add(self.images.shift(steps));
        around.who.extend(self.sorted.rows()[range.clone()].iter().map(|&row| image | row));
        for axis in 0..3 {
            around.positions[axis].extend(self.positions[axis][range.clone()].iter().map(|p| p + shift[axis]));
        }
    }
}

fn coordinates(cell: &PeriodicBox, counts: [usize; 3], position: Vector) -> [usize; 3] {
    let fractions = cell.fractional_coordinates(position).to_array();
    std::array::from_fn(|d| ((fractions[d] * counts[d] as f64).max(0.0) as usize).min(counts[d] - 1))
}

fn place(cell: &PeriodicBox, counts: [usize; 3], position: Vector) -> usize {
    let [x, y, z] = coordinates(cell, counts, position);
    (z * counts[1] + y) * counts[0] + x
}
