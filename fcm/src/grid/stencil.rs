//! Grid points of the particles' stencils.

use domain::Vector;
use domain::parallel::{SortedRows, mapped, of_rows};
use solver::Grid;

/// Size of the stencils of all particles. With the direct method they are the points within the reach, in a box of
/// `lanes` points along x and `support` along y and z; with the split method `support` points along each axis, padded
/// to `lanes` along x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// Points along x, a multiple of eight.
    pub lanes: usize,
    /// Points along y and along z.
    pub support: usize,
    /// Distance from the particle beyond which points are left out, or half the length of the window.
    pub reach: f64,
}

impl Support {
    /// Points along each axis.
    pub fn along_axes(&self) -> [usize; 3] {
        [self.lanes, self.support, self.support]
    }
}

/// First point of one particle's stencil.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stencil {
    /// Row of the particle among those present.
    pub row: u32,
    /// First grid point along each axis, wrapped into the box; along x that of the first row, see
    /// [`Grid::row_shift`].
    pub first: [u32; 3],
    /// Coordinates of that point relative to the particle in the lattice of [`Grid::strain`].
    pub offset: Vector,
}

/// Stencils of `extent` points along each axis for particles at `positions`, sorted by the blocks of their first
/// points.
pub(crate) fn sorted_stencils(grid: &Grid, extent: [usize; 3], positions: &[Vector]) -> Vec<Stencil> {
    let spacing = grid.spacing();
    let points = grid.points().map(|n| n as i32);
    let half = 0.5 * Vector::from_array(extent.map(|n| n as f64));
    let (row_shift, slope) = (grid.row_shift() as i32, spacing.x / spacing.y * grid.row_shift() as f64);
    let stencil = |row: usize| {
        let mut coordinates = grid.cell().lattice_coordinates(positions[row]);
        if row_shift != 0 {
            coordinates.x += slope * coordinates.y;
        }
        let first = (coordinates / spacing - half).ceil();
        let offset = first * spacing - coordinates;
        let [x, y, z] = first.to_array().map(|first| first as i32);
        let wrapped = |d: usize, first: i32| first.rem_euclid(points[d]) as u32;
        let first = [wrapped(0, x - row_shift * y), wrapped(1, y), wrapped(2, z)];
        Stencil { row: row as u32, first, offset }
    };
    let blocks = GridBlocks::of(grid.points());
    // Stencils are computed twice, which takes less time than to read them in another order.
    let key = |row: usize| blocks.index_of(stencil(row).first.map(|p| p as usize)) as u32;
    let keys = of_rows(positions.len(), key);
    mapped(SortedRows::by_key(&keys, blocks.count()).rows(), |&row| stencil(row as usize))
}

/// Order of the grid's blocks in which neighbours in the list are neighbours in memory: columns of blocks along z,
/// one after the other, and within each the blocks layer by layer. The points that stencils of a layer touch stay in
/// the second-level cache, so each plane is fetched from main memory once per column; those of a block stay in the
/// first-level cache.
struct GridBlocks {
    /// Number of columns along x and y, and of layers.
    counts: [usize; 3],
}

/// Points of a block along each axis, and blocks along x and y of a column's layer.
const BLOCK: [usize; 3] = [16, 4, 4];
const COLUMN: [usize; 2] = [4, 16];

impl GridBlocks {
    fn of(points: [usize; 3]) -> Self {
        let column = [COLUMN[0] * BLOCK[0], COLUMN[1] * BLOCK[1], BLOCK[2]];
        Self { counts: std::array::from_fn(|d| points[d].div_ceil(column[d])) }
    }

    fn count(&self) -> usize {
        self.counts.iter().chain(&COLUMN).product()
    }

    /// Index of the block of a point in the order of all blocks.
    fn index_of(&self, point: [usize; 3]) -> usize {
        let [x, y, z] = std::array::from_fn(|d| point[d] / BLOCK[d]);
        let column = y / COLUMN[1] * self.counts[0] + x / COLUMN[0];
        let layer = column * self.counts[2] + z;
        (layer * COLUMN[1] + y % COLUMN[1]) * COLUMN[0] + x % COLUMN[0]
    }
}
