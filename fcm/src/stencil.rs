//! Which grid points a particle's envelope touches.

use domain::Vector;
use rayon::prelude::*;
use solver::Grid;

/// The stencils of all particles. With the direct method those of `lanes` points along x and `support` along y and z
/// that lie within the reach; with the split method `support` points along each axis, for which there is room for
/// `lanes` along x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// Points along x, a multiple of eight.
    pub lanes: usize,
    /// Points along y and along z.
    pub support: usize,
    /// Distance from the particle beyond which points are left out, or which the window spans.
    pub reach: f64,
}

impl Support {
    /// Points along each axis.
    pub fn along_axes(&self) -> [usize; 3] {
        [self.lanes, self.support, self.support]
    }
}

/// Where one particle's stencil begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// Row of the particle among those present.
    pub row: u32,
    /// First grid point along each axis, wrapped into the box; along x that of the first row, see [`Grid::row_shift`].
    pub first: [u32; 3],
    /// Coordinates of that point relative to the particle in the lattice of [`Grid::strain`].
    pub offset: Vector,
}

/// The stencils of so many points along each axis of the particles at `positions`, in the order of the blocks where
/// they begin.
pub(crate) fn places(grid: &Grid, extent: [usize; 3], positions: &[Vector]) -> Vec<Place> {
    let spacing = grid.spacing();
    let points = grid.points().map(|n| n as i32);
    let half = 0.5 * Vector::from_array(extent.map(|n| n as f64));
    let (row_shift, slope) = (grid.row_shift() as i32, spacing.x / spacing.y * grid.row_shift() as f64);
    let unsorted = positions.par_iter().enumerate().map(|(row, &position)| {
        let mut coordinates = grid.cell().lattice_coordinates(position);
        if row_shift != 0 {
            coordinates.x += slope * coordinates.y;
        }
        let first = (coordinates / spacing - half).ceil();
        let offset = first * spacing - coordinates;
        let [x, y, z] = first.to_array().map(|first| first as i32);
        let wrapped = |d: usize, first: i32| first.rem_euclid(points[d]) as u32;
        let first = [wrapped(0, x - row_shift * y), wrapped(1, y), wrapped(2, z)];
        Place { row: row as u32, first, offset }
    });
    let blocks = Blocks::of(grid.points());
    let key = |place: &Place| blocks.place(place.first.map(|p| p as usize));
    sort_by_key(unsorted.collect(), key, blocks.count())
}

/// Blocks of the grid in an order in which neighbours in the list are neighbours in memory: columns of blocks along z,
/// one after the other, and in each the blocks by layers from below. What the stencils of a layer touch stays in the
/// second cache, so that each plane comes from afar once a column; what those of a block touch stays in the first.
struct Blocks {
    /// Columns along x and y, and layers.
    counts: [usize; 3],
}

/// Points of a block along each axis, and blocks of a layer of a column along x and y.
const BLOCK: [usize; 3] = [16, 4, 4];
const COLUMN: [usize; 2] = [4, 16];

impl Blocks {
    fn of(points: [usize; 3]) -> Self {
        let column = [COLUMN[0] * BLOCK[0], COLUMN[1] * BLOCK[1], BLOCK[2]];
        Self { counts: std::array::from_fn(|d| points[d].div_ceil(column[d])) }
    }

    fn count(&self) -> usize {
        self.counts.iter().chain(&COLUMN).product()
    }

    /// The place of the block of a point in the order of all.
    fn place(&self, point: [usize; 3]) -> usize {
        let [x, y, z] = std::array::from_fn(|d| point[d] / BLOCK[d]);
        let column = y / COLUMN[1] * self.counts[0] + x / COLUMN[0];
        let layer = column * self.counts[2] + z;
        (layer * COLUMN[1] + y % COLUMN[1]) * COLUMN[0] + x % COLUMN[0]
    }
}

/// A stable counting sort by keys below `keys`.
fn sort_by_key(places: Vec<Place>, key: impl Fn(&Place) -> usize, keys: usize) -> Vec<Place> {
    if places.len() < keys / 8 {
        let mut places = places;
        places.sort_by_key(key);
        return places;
    }
    let mut starts = vec![0_u32; keys + 1];
    for place in &places {
        starts[key(place) + 1] += 1;
    }
    for k in 1..keys {
        starts[k] += starts[k - 1];
    }
    let mut sorted = places.clone();
    for place in &places {
        let next = &mut starts[key(place)];
        sorted[*next as usize] = *place;
        *next += 1;
    }
    sorted
}
