//! Columns of solutions on a device: the start of a solve from those of former ones, and those of a new one, see
//! `gpu/kernels/history.h`.

use crate::coupled::{CoupledVectors, RESULTS};
use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use crate::lists::DeviceList;
use crate::repeated::CommandList;
use crate::task::{DeviceAddress, KernelTask};
use bytemuck::{Pod, Zeroable};

/// Number of columns from which a solve starts.
pub const GUESSED: usize = 5;

/// Number of all columns of a solution.
pub const COLUMNS: usize = 9;

/// Numbers of a particle in each column of a solution: stresslets of the far field, velocities and angular velocities
/// that other spheres induce, those relative to the background, forces, torques, stresslets, and rates of strain.
pub const COLUMN_WIDTHS: [usize; COLUMNS] = [5, 3, 3, 3, 3, 3, 3, 5, 5];

/// Number of past solutions that are extrapolated.
pub const PAST: usize = 3;

/// Numbers of a particle in all columns of a solution, and in those from which a solve starts.
pub(crate) const SOLUTION: usize = 3 * 5 + 6 * 3;
pub(crate) const GUESS: usize = 5 + 4 * 3;

/// Numbers of a particle that steps keep besides a new solution: the one before, and the columns from which solves
/// start of those before it, one more than are extrapolated while a step may fail.
pub(crate) const KEPT: usize = SOLUTION + PAST * GUESS;

/// Sums of a comparison with a guess, two for each column from which a solve starts; and that of squares of velocities.
const COMPARED: usize = 2 * GUESSED + 1;

/// Columns of past solutions, and weights of their extrapolation.
#[derive(Debug, Clone, Copy)]
pub struct PastLists {
    /// Lists of each column, the last one first; `None` for zeros.
    pub lists: [Option<[DeviceList; PAST]>; GUESSED],
    /// Weights of the past solutions in a line and in a parabola.
    pub line: [f64; PAST],
    /// See [`Self::line`].
    pub parabola: [f64; PAST],
    /// Weight of the parabola in the mix of both, for each column.
    pub blend: [f64; GUESSED],
}

/// Units of the host over those of a solve.
#[derive(Debug, Clone, Copy)]
pub struct ColumnUnits {
    /// Of velocities.
    pub velocity: f64,
    /// Of angular velocities and rates of strain.
    pub rate: f64,
    /// Of torques and stresslets.
    pub torque: f64,
}

/// Particles that move on the device, by lists in the order of ids and in the units of the host.
#[derive(Debug, Clone, Copy)]
pub struct MovingLists {
    /// Positions.
    pub positions: DeviceList,
    /// Velocities and angular velocities, which a solution sets.
    pub motions: [DeviceList; 2],
    /// Velocity gradient of the background, row by row.
    pub gradient: [f64; 9],
    /// Angular velocity of the background.
    pub spin: [f64; 3],
}

/// Columns that a solution sets.
#[derive(Debug, Clone, Copy)]
pub struct FoundLists {
    /// Columns of the solution.
    pub columns: [DeviceList; COLUMNS],
    /// Motions of particles that move on the device.
    pub moving: Option<MovingLists>,
}

/// Vectors from which a solve starts, besides its unknowns.
#[derive(Debug, Clone, Copy)]
pub struct GuessedVectors {
    /// Known loads.
    pub known: DeviceList,
    /// Motions from which near pairs are solved.
    pub motions: DeviceList,
    /// Loads that move single spheres as those of all others do in the guess.
    pub moving: DeviceList,
    /// Minus the stresslets.
    pub moments: DeviceList,
    /// Motions of the fluid, if they are on the device.
    pub ambient: Option<AmbientLists>,
}

/// Motions of the fluid at the particles, eleven numbers each: on the device in the order of ids and in the units of
/// the host, and as [`KnownInput::ambient`](crate::KnownInput::ambient), which the start of a solve sets.
#[derive(Debug, Clone, Copy)]
pub struct AmbientLists {
    /// Velocities, angular velocities and rates of strain of one particle after the other.
    pub given: DeviceList,
    /// See above.
    pub known: DeviceList,
}

/// A solution whose columns are stored: velocities, then angular velocities of all particles, three numbers each,
/// unless they move on the device; the sum of the squares of velocities; and for each column from which solves start,
/// two sums over its numbers `x`, the line `l` and the parabola `p` of the guess: of `(x - l) (p - l)`, and of
/// `(p - l)^2`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StoredResult {
    /// Velocities and angular velocities.
    pub motions: Vec<f64>,
    /// Sum of the squares of velocities.
    pub square: f64,
    /// Sums.
    pub compared: [[f64; 2]; GUESSED],
}

/// Arguments with the fields of `gpu/kernels/history.h` in the same order.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct History {
    past: [[DeviceAddress; PAST]; GUESSED],
    found: [DeviceAddress; COLUMNS],
    line: [f64; PAST],
    parabola: [f64; PAST],
    blend: [f64; GUESSED],
    units: [f64; 3],
    positions: DeviceAddress,
    moving: [DeviceAddress; 2],
    gradient: [f64; 9],
    spin: [f64; 3],
    ambient: DeviceAddress,
}

/// Bytes of these arguments.
pub(crate) const ARGUMENT_BYTES: f64 = size_of::<History>() as f64;

impl SplitFarField {
    /// Sets the place of each row in the columns of solutions, for particles with other ids than before.
    pub fn set_places(&mut self, places: &[u32]) -> Result<(), DeviceError> {
        self.has_ids = false;
        let Self { device, buffers, task, .. } = self;
        task.places = buffers.places.fill(device.as_mut(), bytemuck::cast_slice(places))?;
        Ok(())
    }

    /// Starts a solve from past solutions, with given loads besides those of near pairs in the background, if there are
    /// any. Motions of the fluid that are on the device are those that other spheres induce at the start. The solution
    /// will be stored in the columns `found`.
    pub fn guess_coupled(
        &mut self,
        past: &PastLists,
        found: &FoundLists,
        units: ColumnUnits,
        given: Option<DeviceList>,
        at: &GuessedVectors,
    ) -> Result<(), DeviceError> {
        let lists = past.lists.map(|lists| lists.map_or([0; PAST], |lists| lists.map(|list| list.address)));
        let &PastLists { line, parabola, blend, .. } = past;
        let ColumnUnits { velocity, rate, torque } = units;
        let mut history = History {
            past: lists,
            found: found.columns.each_ref().map(|list| list.address),
            line,
            parabola,
            blend,
            units: [velocity, rate, torque],
            ..History::zeroed()
        };
        if let Some(MovingLists { positions, motions, gradient, spin }) = found.moving {
            (history.positions, history.moving) = (positions.address, motions.map(|list| list.address));
            (history.gradient, history.spin) = (gradient, spin);
        }
        history.ambient = at.ambient.map_or(0, |lists| lists.given.address);
        let Self { device, buffers, task, .. } = self;
        task.history = buffers.history.fill(device.as_mut(), bytemuck::bytes_of(&history))?;
        let ambient = given.map_or(0, |list| list.address);
        let [image, unknowns, stiff_loads, list_y] =
            [at.known, at.motions, at.moving, at.moments].map(|list| list.address);
        let residual = at.ambient.map_or(0, |lists| lists.known.address);
        let task = KernelTask { list_y, unknowns, residual, image, stiff_loads, ambient, ..self.task };
        self.launch_particles("guess_all", &task)
    }

    /// Stores the solution after the preconditioned residual as a last correction, in the columns that the start of
    /// this solve was given, with known loads and first moments in the background besides those of near pairs, if there
    /// are any. Motions are copied unless particles move on the device.
    pub fn store_coupled(
        &mut self,
        at: &CoupledVectors,
        known: &DeviceList,
        given_moments: Option<DeviceList>,
        are_moving: bool,
    ) -> Result<StoredResult, DeviceError> {
        let (count, blocks) = (self.task.particles as usize, self.blocks());
        let (result, motions) = (self.wide_list(RESULTS * count)?, self.wide_list(6 * count)?);
        let [direction, image, ambient] = [result, motions, *known].map(|list| list.address);
        let (moments, list_weights) = (self.place_of_moments()?, given_moments.map_or(0, |list| list.address));
        let sums = self.buffers.compared.reserve(self.device.as_mut(), size_of::<f64>() * COMPARED * (1 + blocks))?;
        let totals = sums + (size_of::<f64>() * COMPARED * blocks) as u64;
        let [unknowns, residual, z] = [at.unknowns, at.residual, at.preconditioned].map(|list| list.address);
        let addresses = [unknowns, residual, z, direction, image, ambient, moments, list_weights, sums];
        self.repeat(CommandList::Result, &addresses, |field| {
            field.gather_coupled(at, &result, moments)?;
            let (list_x, list_sums, list_size) = (moments, sums, blocks as i64);
            let task =
                KernelTask { list_x, list_weights, list_sums, direction, image, ambient, list_size, ..field.task };
            field.launch_particles("store_all", &task)?;
            field.launch_particles("compare_all", &task)?;
            field.launch_sums(sums, blocks, COMPARED, totals)
        })?;
        let mut stored =
            StoredResult { motions: vec![0.0; if are_moving { 0 } else { 6 * count }], ..StoredResult::default() };
        let mut of_sums = [0.0; COMPARED];
        if count > 0 {
            let mut parts = vec![(totals, bytemuck::cast_slice_mut(&mut of_sums))];
            if !are_moving {
                parts.push((image, bytemuck::cast_slice_mut(&mut stored.motions)));
            }
            self.device.download_all(&mut parts)?;
        }
        let (compared, square) = of_sums.split_at(COMPARED - 1);
        stored.compared.as_flattened_mut().copy_from_slice(compared);
        stored.square = square[0];
        self.release(&result);
        self.release(&motions);
        Ok(stored)
    }
}
