//! Rows of the resistance of near pairs.

use crate::buffers::Buffer;
use crate::device::{Device, DeviceError};
use crate::tables::NumberFormat;
use crate::task::DeviceAddress;

/// Numbers of a pair: the axis; translation across it, and along it minus across; rotation in the same way; force by
/// rotation of the other sphere, and torque by its translation.
pub const PAIR_NUMBERS: usize = 9;

/// Numbers of the resistance of a sphere to its own motion: force by velocity and torque by rotation, each with the
/// components xx, xy, xz, yy, yz and zz, and the vector `c` of the coupling `F = Omega x c`, `L = c x U`.
pub const OWN_NUMBERS: usize = 15;

/// Numbers of the lower triangle of a block of six, row by row.
pub const TRIANGLE: usize = 21;

/// Resistance of near pairs as a matrix with a row of blocks for each particle, in the order of the host.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PairRows {
    /// The first pair of each row, and the number of all pairs.
    pub starts: Vec<i32>,
    /// The other particle of each pair.
    pub others: Vec<i32>,
    /// Numbers of the pairs: [`PAIR_NUMBERS`] lists, one after the other.
    pub numbers: Vec<f64>,
    /// Resistance of each particle to its own motion, [`OWN_NUMBERS`] each.
    pub own: Vec<f64>,
}

/// Near field of a solve.
#[derive(Debug, Clone, Copy)]
pub struct NearInput<'a> {
    /// Stiff pairs, which the preconditioner has, in `f64`.
    pub stiff: &'a PairRows,
    /// Soft pairs, in the precision of the grid.
    pub soft: &'a PairRows,
    /// Inverses of the resistances of single spheres and of stiff pairs to each particle's own motion, the lower
    /// triangles of [`TRIANGLE`] numbers.
    pub inverses: &'a [f64],
    /// Resistances of single spheres to translation, rotation and strain, by class of radius.
    pub resistances: &'a [[f64; 3]],
}

/// Selection of near pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairSet {
    /// Stiff pairs.
    Stiff,
    /// Soft pairs.
    Soft,
    /// Both.
    All,
}

/// Rows of a set of pairs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowAddresses {
    pub starts: DeviceAddress,
    pub others: DeviceAddress,
    pub numbers: DeviceAddress,
    pub own: DeviceAddress,
    pub pairs: i64,
    pub format: NumberFormat,
}

impl Default for RowAddresses {
    fn default() -> Self {
        Self { starts: 0, others: 0, numbers: 0, own: 0, pairs: 0, format: NumberFormat::Double }
    }
}

/// Rows of stiff and of soft pairs.
#[derive(Debug, Default)]
pub(crate) struct NearRows {
    pub stiff: RowAddresses,
    pub soft: RowAddresses,
}

/// Memory of the near field.
#[derive(Default)]
pub(crate) struct NearBuffers {
    pub stiff: [Buffer; 4],
    pub soft: [Buffer; 4],
    pub inverses: Buffer,
    pub resistances: Buffer,
}

impl RowAddresses {
    pub fn fill(
        [starts, others, numbers, own]: &mut [Buffer; 4],
        on: &mut dyn Device,
        rows: &PairRows,
        format: NumberFormat,
    ) -> Result<Self, DeviceError> {
        Ok(Self {
            starts: starts.fill(on, bytemuck::cast_slice(&rows.starts))?,
            others: others.fill(on, bytemuck::cast_slice(&rows.others))?,
            numbers: numbers.fill(on, &format.bytes_of(rows.numbers.iter().copied()))?,
            own: own.fill(on, bytemuck::cast_slice(&rows.own))?,
            pairs: rows.others.len() as i64,
            format,
        })
    }
}
