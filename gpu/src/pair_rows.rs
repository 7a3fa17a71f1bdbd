//! Rows of the resistance of near pairs.

use crate::buffers::Buffer;
use crate::device::{Device, DeviceError};
use crate::repeated::COMMAND_LISTS;
use crate::task::KernelTask;

/// Numbers of a pair: the axis; translation across it, and along it minus across; rotation in the same way; force by
/// rotation of the other sphere, and torque by its translation.
pub const PAIR_NUMBERS: usize = 9;

/// Numbers of the resistance of a sphere to its own motion: force by velocity and torque by rotation, each with the
/// components xx, xy, xz, yy, yz and zz, and the vector `c` of the coupling `F = Omega x c`, `L = c x U`.
pub const OWN_NUMBERS: usize = 15;

/// Numbers of the first moment of a sphere at walls across z by its own motion: `X`, `Y` and `H` of
///
/// ```text
/// M_xx = M_yy = -X U_z,    M_xz = Y U_x + H Omega_y,    M_yz = Y U_y - H Omega_x,    M_xy = 0
/// ```
pub const WALL_NUMBERS: usize = 3;

/// Threads of a row, as in `gpu/kernels/near.h`.
pub(crate) const ROW_LANES: usize = 8;

/// Sums of a step, as in `gpu/kernels/pair_steps.h`.
pub(crate) const PAIR_SUMS: usize = 4;

/// Numbers of a particle at rest in the background: a load, and a first moment.
pub const IN_FLOW: usize = 6 + 5;

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
    /// First moment of each particle by its own motion at walls across z, [`WALL_NUMBERS`] each; empty without walls.
    pub at_walls: Vec<f64>,
}

/// Selection of near pairs: a bit for each set of `gpu/kernels/task.h`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairSet {
    /// Stiff pairs.
    Stiff = 1,
    /// Soft pairs.
    Soft,
    /// Both.
    All,
}

/// Near pairs that are on the device.
#[derive(Debug, Default)]
pub(crate) struct NearRows {
    /// The distance up to which pairs are lubricated if their tables are there.
    pub reach: Option<f64>,
    /// The distance up to which the contacts touch that were found last.
    pub reach_of_contacts: f64,
    /// Steps that each list of commands takes of an iteration, besides the first ones.
    pub more_steps: [usize; COMMAND_LISTS],
}

/// Memory of the rows of a set of pairs.
#[derive(Default)]
pub(crate) struct RowBuffers {
    pub starts: Buffer,
    pub others: Buffer,
    pub steps: Buffer,
    pub numbers: Buffer,
    pub own: Buffer,
    pub at_walls: Buffer,
}

/// Memory of the tables of lubrication.
#[derive(Default)]
pub(crate) struct TableBuffers {
    pub kinds: Buffer,
    pub series: Buffer,
    pub resistances: Buffer,
}

/// Memory of the groups of the preconditioner.
#[derive(Default)]
pub(crate) struct GroupBuffers {
    pub groups: Buffer,
    pub sizes: Buffer,
    pub members: Buffer,
    pub inverses: Buffer,
}

/// Memory of the near field.
#[derive(Default)]
pub(crate) struct NearBuffers {
    pub tables: TableBuffers,
    pub sets: [RowBuffers; 2],
    /// Rows that the host gives.
    pub given: RowBuffers,
    pub groups: GroupBuffers,
    pub in_flow: Buffer,
    pub moments: Buffer,
}

impl KernelTask {
    /// Copies the rows that the host gives.
    pub(crate) fn give(
        &mut self,
        places: &mut RowBuffers,
        on: &mut dyn Device,
        rows: &PairRows,
    ) -> Result<(), DeviceError> {
        self.given_starts = places.starts.fill(on, bytemuck::cast_slice(&rows.starts))?;
        self.given_others = places.others.fill(on, bytemuck::cast_slice(&rows.others))?;
        self.given_numbers = places.numbers.fill(on, bytemuck::cast_slice(&rows.numbers))?;
        self.given_own = places.own.fill(on, bytemuck::cast_slice(&rows.own))?;
        let at_walls = bytemuck::cast_slice(&rows.at_walls);
        self.given_at_walls = if at_walls.is_empty() { 0 } else { places.at_walls.fill(on, at_walls)? };
        Ok(())
    }
}
