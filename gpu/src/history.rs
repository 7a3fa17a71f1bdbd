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
const GUESS: usize = 5 + 4 * 3;

/// Numbers of a particle that steps keep besides a new solution: the one before, and the columns from which solves
/// start of those before it, one more than are extrapolated while a step may fail.
pub(crate) const KEPT: usize = SOLUTION + PAST * GUESS;

/// Sums of a comparison with a guess: two for each column from which a solve starts.
const COMPARED: usize = 2 * GUESSED;

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
}

/// A solution whose columns are stored: velocities, then angular velocities of all particles, three numbers each, and
/// for each column from which solves start, two sums over its numbers `x`, the line `l` and the parabola `p` of the
/// guess: of `(x - l) (p - l)`, and of `(p - l)^2`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StoredResult {
    /// Velocities and angular velocities.
    pub motions: Vec<f64>,
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
}

impl SplitFarField {
    /// Sets the place of each row in the columns of solutions.
    pub fn set_places(&mut self, places: &[u32]) -> Result<(), DeviceError> {
        let Self { device, buffers, task, .. } = self;
        task.places = buffers.places.fill(device.as_mut(), bytemuck::cast_slice(places))?;
        Ok(())
    }

    /// Starts a solve from past solutions, with given loads besides those of near pairs in the background, if there are
    /// any. The solution will be stored in the columns `found`.
    pub fn guess_coupled(
        &mut self,
        past: &PastLists,
        found: &[DeviceList; COLUMNS],
        units: ColumnUnits,
        given: Option<DeviceList>,
        at: &GuessedVectors,
    ) -> Result<(), DeviceError> {
        let lists = past.lists.map(|lists| lists.map_or([0; PAST], |lists| lists.map(|list| list.address)));
        let &PastLists { line, parabola, blend, .. } = past;
        let ColumnUnits { velocity, rate, torque } = units;
        let found = found.each_ref().map(|list| list.address);
        let history = History { past: lists, found, line, parabola, blend, units: [velocity, rate, torque] };
        let Self { device, buffers, task, .. } = self;
        task.history = buffers.history.fill(device.as_mut(), bytemuck::bytes_of(&history))?;
        let ambient = given.map_or(0, |list| list.address);
        let [image, unknowns, stiff_loads, list_y] =
            [at.known, at.motions, at.moving, at.moments].map(|list| list.address);
        let task = KernelTask { list_y, unknowns, image, stiff_loads, ambient, ..self.task };
        self.launch_particles("guess_all", &task)
    }

    /// Stores the solution after the preconditioned residual as a last correction, in the columns that the start of
    /// this solve was given, with known loads and first moments in the background besides those of near pairs, if there
    /// are any. Compares it with the guess if all columns have past solutions.
    pub fn store_coupled(
        &mut self,
        at: &CoupledVectors,
        known: &DeviceList,
        given_moments: Option<DeviceList>,
        is_compared: bool,
    ) -> Result<StoredResult, DeviceError> {
        let (count, blocks) = (self.task.particles as usize, self.blocks());
        let (result, motions) = (self.wide_list(RESULTS * count)?, self.wide_list(6 * count)?);
        let [direction, image, ambient] = [result, motions, *known].map(|list| list.address);
        let (moments, list_weights) = (self.place_of_moments()?, given_moments.map_or(0, |list| list.address));
        let sums = self.buffers.compared.reserve(self.device.as_mut(), size_of::<f64>() * COMPARED * (1 + blocks))?;
        let totals = sums + (size_of::<f64>() * COMPARED * blocks) as u64;
        let [unknowns, residual, z] = [at.unknowns, at.residual, at.preconditioned].map(|list| list.address);
        let addresses = [unknowns, residual, z, direction, image, ambient, moments, list_weights, sums];
        let addresses: Vec<_> = addresses.into_iter().chain([u64::from(is_compared)]).collect();
        self.repeat(CommandList::Result, &addresses, |field| {
            field.gather_coupled(at, &result, moments)?;
            let (list_x, list_sums, list_size) = (moments, sums, blocks as i64);
            let task =
                KernelTask { list_x, list_weights, list_sums, direction, image, ambient, list_size, ..field.task };
            field.launch_particles("store_all", &task)?;
            if is_compared {
                field.launch_particles("compare_all", &task)?;
                field.launch_sums(sums, blocks, COMPARED, totals)?;
            }
            Ok(())
        })?;
        let mut stored = StoredResult { motions: vec![0.0; 6 * count], ..StoredResult::default() };
        let of_motions = (image, bytemuck::cast_slice_mut(&mut stored.motions));
        if is_compared && count > 0 {
            let of_sums = (totals, bytemuck::cast_slice_mut(&mut stored.compared));
            self.device.download_all(&mut [of_motions, of_sums])?;
        } else {
            self.device.download_all(&mut [of_motions])?;
        }
        self.release(&result);
        self.release(&motions);
        Ok(stored)
    }
}
