//! Where the values of a rank's share stand in memory, in each stage of a transform.

use crate::Real;
use domain::{Place, block};
use num_complex::Complex;
use std::ops::Range;

/// The share of one rank. Physical values stand in rows along x, [component][z][y][x], with room for a halo after each
/// row; rows and planes are odd numbers of cache lines, so that columns across them do not compete for the same places
/// of the cache, and components are a third of a page apart, for the same reason. A spectral row has `nx/2` complex
/// values, in blocks: the real parts of a few neighbours, as many as fill a cache line, then their imaginary parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Layout {
    pub points: [usize; 3],
    /// Lines along y and along z that this rank owns in physical space.
    pub rows: [Range<usize>; 2],
    /// Blocks along x and modes along y that this rank owns in spectral space.
    pub blocks: Range<usize>,
    pub modes: Range<usize>,
    /// Reals of room after each row.
    pub halo: usize,
    /// Distances between neighbours in x-rows and z-pencils, in reals.
    pub physical: Strides,
    pub transposed: Strides,
    pub spectral: Strides,
    /// Reals of room that every stage fits in.
    pub capacity: usize,
    /// Reals of this rank's blocks of a spectral row, and of the whole row.
    pub width: usize,
    pub width_in_all: usize,
}

/// Distances in memory between neighbours, in reals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Strides {
    pub component: usize,
    pub z: usize,
    pub y: usize,
}

impl Strides {
    /// The first value of a row.
    pub fn at(&self, component: usize, y: usize, z: usize) -> usize {
        component * self.component + z * self.z + y * self.y
    }
}

impl Layout {
    pub fn new<T: Real>(points: [usize; 3], place: &Place, halo: usize) -> Self {
        let [nx, ny, nz] = points;
        assert_eq!(place.lines(), [ny, nz], "the partition shares out the lines of this grid");
        let block_size = 2 * T::LANES;
        let blocks_in_all = (nx / 2).div_ceil(T::LANES);
        let rows = place.owned();
        let ([in_column, in_row], [row, column]) = (place.table(), place.index());
        let blocks = block(blocks_in_all, in_column, row);
        let modes = block(ny, in_row, column);
        let odd_lines = |reals: usize| (reals.div_ceil(T::LANES) | 1) * T::LANES;
        let y = odd_lines((nx + halo).max(blocks_in_all * block_size));
        let z = odd_lines(rows[0].len() * y);
        let physical = Strides { component: apart::<T>(rows[1].len() * z), z, y };
        let width = blocks.len() * block_size;
        let transposed = if in_column == 1 {
            physical
        } else {
            Strides { component: width, z: 3 * width, y: 3 * width * rows[1].len() }
        };
        let spectral = if in_row == 1 {
            transposed
        } else {
            Strides { component: width * modes.len(), z: 3 * width * modes.len(), y: width }
        };
        let capacity = [3 * physical.component, 3 * width * ny * rows[1].len(), 3 * width * modes.len() * nz];
        let capacity = capacity.into_iter().max().unwrap_or(0);
        let width_in_all = blocks_in_all * block_size;
        Self { points, rows, blocks, modes, halo, physical, transposed, spectral, capacity, width, width_in_all }
    }
}

impl Layout {
    /// Rounds in which so many ranks of a row make columns along z whole, of at most so many reals each: the same on all.
    pub fn rounds(&self, ranks: usize, room: usize) -> usize {
        let modes = self.points[1].div_ceil(ranks);
        (3 * self.points[2] * modes * self.width_in_all).div_ceil(room).clamp(1, modes)
    }

    /// Calls `visit(mode, values)` for each mode of this rank's that is one of some along y, with coefficients that stand
    /// at such strides and are read by their places.
    pub fn for_each_mode<T: Real>(
        &self,
        (strides, modes): (&Strides, &Range<usize>),
        read: impl Fn(usize) -> T,
        visit: &mut impl FnMut([usize; 3], [Complex<T>; 3]),
    ) {
        let [nx, _, nz] = self.points;
        let columns = self.blocks.start * T::LANES..(self.blocks.end * T::LANES).min(nx / 2);
        for m3 in 0..nz {
            for m2 in modes.clone() {
                for m1 in columns.clone() {
                    let value = |component| {
                        let real = strides.at(component, m2 - modes.start, m3) + self.in_row::<T>(m1);
                        Complex::new(read(real), read(real + T::LANES))
                    };
                    visit([m1, m2, m3], std::array::from_fn(value));
                }
            }
        }
    }

    /// Where the real part of a mode stands in its spectral row; the imaginary part follows by a vector's lanes.
    pub fn in_row<T: Real>(&self, m1: usize) -> usize {
        (m1 / T::LANES - self.blocks.start) * 2 * T::LANES + m1 % T::LANES
    }
}

/// At least so many reals, and a third of a page more than whole pages: 21 of 64 cache lines. Processors take a read
/// for one of what was just written if both are equally far into a page.
fn apart<T: Real>(reals: usize) -> usize {
    const PAGE: usize = 64;
    let lines = reals.div_ceil(T::LANES);
    (lines + (PAGE + PAGE / 3 - lines % PAGE) % PAGE) * T::LANES
}
