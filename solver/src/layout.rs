//! Memory layout of a rank's share in each stage of a transform.

use crate::Real;
use domain::{Place, block};
use num_complex::Complex;
use std::ops::Range;

/// Layout of one rank's share of a field of some components. Physical values are in rows along x,
/// `[component][z][y][x]`, with room for a halo after each row. Rows and planes have an odd number of cache lines, so
/// that columns across them do not compete for the same cache sets, and components are offset by a third of a page, for
/// the same reason. A spectral row has `nx/2` complex values, in blocks: the real parts of as many neighbours as fill a
/// cache line, then their imaginary parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Layout {
    pub components: usize,
    pub points: [usize; 3],
    /// Ranges of rows along y and along z that this rank owns in physical space.
    pub rows: [Range<usize>; 2],
    /// Blocks along x and modes along y that this rank owns in spectral space.
    pub blocks: Range<usize>,
    pub modes: Range<usize>,
    /// Length of the halo after each row.
    pub halo: usize,
    /// Distances in values between neighbours in x-rows and z-pencils.
    pub physical: Strides,
    pub transposed: Strides,
    pub spectral: Strides,
    /// Number of values that suffices for every stage.
    pub capacity: usize,
    /// Number of values in this rank's blocks of a spectral row, and in the whole row.
    pub width: usize,
    pub width_in_all: usize,
}

/// Distances in memory between neighbours, in values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Strides {
    pub component: usize,
    pub z: usize,
    pub y: usize,
}

impl Strides {
    /// Index of the first value of a row.
    pub fn at(&self, component: usize, y: usize, z: usize) -> usize {
        component * self.component + z * self.z + y * self.y
    }
}

impl Layout {
    pub fn new<T: Real>(components: usize, points: [usize; 3], place: &Place, halo: usize) -> Self {
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
        let physical = Strides { component: offset_stride::<T>(rows[1].len() * z), z, y };
        let width = blocks.len() * block_size;
        let transposed = if in_column == 1 {
            physical
        } else {
            Strides { component: width, z: components * width, y: components * width * rows[1].len() }
        };
        let spectral = if in_row == 1 {
            transposed
        } else {
            Strides { component: width * modes.len(), z: components * width * modes.len(), y: width }
        };
        let capacity = [physical.component, width * ny * rows[1].len(), width * modes.len() * nz];
        let capacity = components * capacity.into_iter().max().unwrap_or(0);
        let width_in_all = blocks_in_all * block_size;
        Self {
            components,
            points,
            rows,
            blocks,
            modes,
            halo,
            physical,
            transposed,
            spectral,
            capacity,
            width,
            width_in_all,
        }
    }
}

/// Rows of modes along x in a plane in memory.
#[derive(Clone, Copy)]
pub struct ModeRows<'a> {
    pub strides: &'a Strides,
    /// Indices along y.
    pub modes: &'a Range<usize>,
    /// Index along z.
    pub m3: usize,
}

impl Layout {
    /// Number of rounds in which `ranks` ranks of a row exchange columns along z, of at most `room` values each: the
    /// same on all ranks.
    pub fn rounds(&self, ranks: usize, room: usize) -> usize {
        let modes = self.points[1].div_ceil(ranks);
        (self.components * self.points[2] * modes * self.width_in_all).div_ceil(room).clamp(1, modes)
    }

    /// Folds `visit(state, mode, values)` over the modes of this rank with an index along y in `rows` and the index
    /// `m3` along z; `read` returns the value at a position given by the strides.
    #[inline(always)]
    pub fn fold_modes_of_plane<T: Real, S, const C: usize>(
        &self,
        ModeRows { strides, modes, m3 }: ModeRows,
        read: impl Fn(usize) -> T,
        mut state: S,
        mut visit: impl FnMut(S, [usize; 3], [Complex<T>; C]) -> S,
    ) -> S {
        let columns = self.blocks.start * T::LANES..(self.blocks.end * T::LANES).min(self.points[0] / 2);
        for m2 in modes.clone() {
            for m1 in columns.clone() {
                let value = |component| {
                    let real = strides.at(component, m2 - modes.start, m3) + self.in_row::<T>(m1);
                    Complex::new(read(real), read(real + T::LANES))
                };
                state = visit(state, [m1, m2, m3], std::array::from_fn(value));
            }
        }
        state
    }

    /// Position of the real part of a mode in its spectral row; the imaginary part follows after a vector's lanes.
    pub fn in_row<T: Real>(&self, m1: usize) -> usize {
        (m1 / T::LANES - self.blocks.start) * 2 * T::LANES + m1 % T::LANES
    }
}

/// Length of at least `reals` values that is a third of a page (21 of 64 cache lines) more than whole pages.
/// Processors mistake a read for one of recently written data if both have the same offset in a page.
fn offset_stride<T: Real>(reals: usize) -> usize {
    const PAGE: usize = 64;
    let lines = reals.div_ceil(T::LANES);
    (lines + (PAGE + PAGE / 3 - lines % PAGE) % PAGE) * T::LANES
}
