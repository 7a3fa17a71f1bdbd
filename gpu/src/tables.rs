//! Tables of the split method, as a device takes them.

use crate::share::GridShare;
use domain::parallel::mapped;
use std::borrow::Cow;
use std::ops::Range;

/// Precision of all values on a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberFormat {
    /// `f32`
    Single,
    /// `f64`
    Double,
}

impl NumberFormat {
    /// Bytes of a value.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::Single => 4,
            Self::Double => 8,
        }
    }

    /// Ending of the names of kernels.
    pub(crate) fn suffix(self) -> &'static str {
        match self {
            Self::Single => "f32",
            Self::Double => "f64",
        }
    }

    /// Bytes of values in this precision.
    pub(crate) fn bytes_of(self, values: &[f64]) -> Cow<'_, [u8]> {
        match self {
            Self::Single => mapped(values, |&value| (value as f32).to_ne_bytes()).into_flattened().into(),
            Self::Double => bytemuck::cast_slice(values).into(),
        }
    }
}

/// Fractions of the box's edges in units of `2^-64`, as unsigned integers that are wrapped at one.
pub(crate) fn fixed_points(fractions: &[f64]) -> Vec<u8> {
    mapped(fractions, |&fraction| (scaled(fraction) as u64).to_ne_bytes()).into_flattened()
}

/// Whole edges that [`fixed_points`] leaves out of fractions.
pub(crate) fn periods_of(fractions: &[f64]) -> impl Iterator<Item = i32> {
    fractions.iter().map(|&fraction| fraction.floor() as i32 + (scaled(fraction) >> 64) as i32)
}

/// Part of a fraction beyond whole edges, up to `2^64`, where it is rounded to one.
fn scaled(fraction: f64) -> u128 {
    ((fraction - fraction.floor()) * 2_f64.powi(64)).round() as u128
}

/// Polynomials of a derivative of the window: coefficients from the highest power on, each a row of the points.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowPolynomials(pub Vec<f64>);

/// Pair functions of two classes, as polynomials about the middles of equal intervals of the squared distance.
#[derive(Debug, Clone, PartialEq)]
pub struct DevicePairTable {
    /// Number of intervals per unit of the square.
    pub per_square: f64,
    /// Coefficients of an interval by power, of nine functions each.
    pub coefficients: Vec<[[f64; 9]; 6]>,
}

impl DevicePairTable {
    /// Coefficients as a list.
    pub(crate) fn numbers(&self) -> &[f64] {
        self.coefficients.as_flattened().as_flattened()
    }
}

/// Tables of a plan that do not depend on the shape of the box.
#[derive(Debug, Clone, PartialEq)]
pub struct SplitTables {
    /// Precision.
    pub numbers: NumberFormat,
    /// Grid points along each edge.
    pub grid: [usize; 3],
    /// Part of the grid that the device has.
    pub share: GridShare,
    /// Points of the window.
    pub points: usize,
    /// The window and its first three derivatives.
    pub window: [WindowPolynomials; 4],
    /// Tables of all ordered pairs of classes, those of the first class first.
    pub pairs: Vec<DevicePairTable>,
    /// First function of two forces and first function of two dipoles at distance 0, by class.
    pub isolated: Vec<[f64; 2]>,
    /// Distance beyond which pairs are left out.
    pub cutoff: f64,
    /// Viscosity.
    pub viscosity: f64,
    /// Square of the width of the common Gaussian.
    pub gaussian: f64,
    /// Coefficient of `k^2` in the bracket of the Gaussian.
    pub widening: f64,
    /// Axes along which the box repeats.
    pub is_periodic: [bool; 3],
    /// Solve on the grid.
    pub solve: GridSolve,
}

/// Solve on the grid.
#[derive(Debug, Clone, PartialEq)]
pub enum GridSolve {
    /// By the Green's function of a periodic box.
    Periodic,
    /// By a kernel of unbounded fluid, with the volume of a grid point: entries xx, xy, xz, yy, yz and zz of a tensor,
    /// each by modes `[m3][m2][m1]` with `m1 < nx/2`, `m2 <= ny/2` and `m3 <= nz/2`.
    Unbounded(Vec<f64>),
    /// As in a periodic box, and by the flow of walls or open faces across z.
    Channel(ChannelColumns),
}

/// Numbers of the flow of walls or open faces, with the volume of a grid point.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelColumns {
    /// Numbers of the columns of modes, each by `[m2][m1]` with `m1 <= nx/2`: decay from plane to plane, 0 without an
    /// update, direction of the wavevector, and both matrices.
    pub columns: Vec<f64>,
    /// Weights of the planes for the three functions of the mean.
    pub mean_planes: Vec<[f64; 3]>,
    /// Matrix of the mean.
    pub mean_kernel: [[f64; 3]; 3],
}

impl ChannelColumns {
    /// The same numbers of the columns with some modes along y.
    pub(crate) fn columns_of(&self, [x, y, _]: [usize; 3], modes: &Range<usize>) -> Cow<'_, [f64]> {
        if modes.len() == y {
            return Cow::Borrowed(&self.columns);
        }
        let row = x / 2 + 1;
        let of_number = |all: &[f64]| all[row * modes.start..row * modes.end].to_vec();
        self.columns.chunks(row * y).flat_map(of_number).collect()
    }
}

/// Numbers of a column, and of its amplitudes, as in `gpu/kernels/channel.h`.
pub const COLUMN_NUMBERS: usize = 3 + 36 + 3;
pub(crate) const AMPLITUDES: usize = 24;

/// Shape of the box, and tables that depend on it.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeShape {
    /// Edges along the lattice coordinates.
    pub edges: [f64; 3],
    /// Strain `s`.
    pub strain: f64,
    /// Tilts `t` and `r`.
    pub tilts: [f64; 2],
    /// Height of the first point of the grid.
    pub lowest: f64,
    /// Axes of the box as rows of a matrix that maps components along them to components in space, if they differ.
    pub axes: Option<[f64; 9]>,
    /// Coefficients of the Laplacian along the lattice, of monopoles and dipoles, by class.
    pub smoothing: Vec<[[f64; 6]; 2]>,
    /// Logarithms of the factors of the multiplier that depend on one mode alone, by axis; along x of `m <= nx/2`.
    pub levels: [Vec<f64>; 3],
}

impl SplitTables {
    /// Number of classes of radius.
    pub(crate) fn classes(&self) -> usize {
        self.isolated.len()
    }

    /// The axes along which the box does not repeat, a bit each.
    pub(crate) fn bounded_axes(&self) -> i32 {
        (0..3).filter(|&axis| !self.is_periodic[axis]).map(|axis| 1 << axis).sum()
    }

    /// Number of grid points of the device.
    pub(crate) fn count(&self) -> usize {
        self.grid[0] * self.grid[1] * self.share.own_planes().len()
    }

    /// Number of columns of modes along z of the device.
    pub(crate) fn columns(&self) -> usize {
        (self.grid[0] / 2 + 1) * self.share.own_modes().len()
    }

    /// Number of modes of a component in these columns.
    pub(crate) fn modes(&self) -> usize {
        self.columns() * self.grid[2]
    }

    /// Number of modes of a component in the planes of the device.
    pub(crate) fn modes_of_planes(&self) -> usize {
        (self.grid[0] / 2 + 1) * self.grid[1] * self.share.own_planes().len()
    }

    /// Numbers of values of the field and of the spectrum. The modes that devices exchange are in the memory of the
    /// field.
    pub(crate) fn values(&self) -> [usize; 2] {
        let spectrum = 6 * self.modes().max(self.modes_of_planes());
        let field = 3 * self.count();
        [if self.share.is_whole() { field } else { field.max(spectrum) }, spectrum]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fractions are wrapped into the box, also those that are rounded to its end.
    #[test]
    fn fixed_points_are_wrapped() {
        let points = fixed_points(&[0.25, -0.25, 3.5, 1.0, -1e-30]);
        let points: Vec<u64> = points.as_chunks().0.iter().map(|&bytes| u64::from_ne_bytes(bytes)).collect();
        assert_eq!(points, [1 << 62, 3 << 62, 1 << 63, 0, 0]);
    }

    /// Lists of any length have the same numbers as their values one by one, in both precisions.
    #[test]
    fn values_keep_their_order() {
        let values: Vec<f64> = (0..100_001).map(|k| f64::from(k).sqrt()).collect();
        let singles: Vec<u8> = values.iter().flat_map(|&value| (value as f32).to_ne_bytes()).collect();
        let doubles: Vec<u8> = values.iter().flat_map(|value| value.to_ne_bytes()).collect();
        assert_eq!(*NumberFormat::Single.bytes_of(&values), singles[..]);
        assert_eq!(*NumberFormat::Double.bytes_of(&values), doubles[..]);
    }
}
