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

/// Rows of stiff and of soft pairs, and the distance up to which pairs are lubricated if their tables are there.
#[derive(Debug, Default)]
pub(crate) struct NearRows {
    pub stiff: RowAddresses,
    pub soft: RowAddresses,
    pub reach: Option<f64>,
}

/// Memory of the rows of a set of pairs.
#[derive(Default)]
pub(crate) struct RowBuffers {
    pub starts: Buffer,
    pub others: Buffer,
    pub steps: Buffer,
    pub numbers: Buffer,
    pub own: Buffer,
}

/// Memory of the tables of lubrication.
#[derive(Default)]
pub(crate) struct TableBuffers {
    pub kinds: Buffer,
    pub series: Buffer,
    pub resistances: Buffer,
}

/// Memory of the near field.
#[derive(Default)]
pub(crate) struct NearBuffers {
    pub tables: TableBuffers,
    pub sets: [RowBuffers; 2],
    /// Rows that the host gives.
    pub given: RowBuffers,
    pub inverses: Buffer,
    pub in_flow: Buffer,
    pub moments: Buffer,
}

impl RowAddresses {
    /// A copy of rows of the host.
    pub fn fill(places: &mut RowBuffers, on: &mut dyn Device, rows: &PairRows) -> Result<Self, DeviceError> {
        Ok(Self {
            starts: places.starts.fill(on, bytemuck::cast_slice(&rows.starts))?,
            others: places.others.fill(on, bytemuck::cast_slice(&rows.others))?,
            numbers: places.numbers.fill(on, bytemuck::cast_slice(&rows.numbers))?,
            own: places.own.fill(on, bytemuck::cast_slice(&rows.own))?,
            pairs: rows.others.len() as i64,
            format: NumberFormat::Double,
        })
    }

    /// Room for the rows of some particles with this many pairs; the place where they begin is known.
    pub fn reserve(
        places: &mut RowBuffers,
        on: &mut dyn Device,
        [particles, pairs]: [usize; 2],
        format: NumberFormat,
    ) -> Result<Self, DeviceError> {
        Ok(Self {
            starts: places.starts.reserve(on, 4 * (particles + 1))?,
            others: places.others.reserve(on, 4 * pairs)?,
            numbers: places.numbers.reserve(on, PAIR_NUMBERS * pairs * format.size())?,
            own: places.own.reserve(on, size_of::<f64>() * OWN_NUMBERS * particles)?,
            pairs: pairs as i64,
            format,
        })
    }
}
