//! Search for near pairs and assembly of their resistance on a device, see `gpu/kernels/assembly.h`.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::{PARTICLE_THREADS, SplitFarField};
use crate::groups::INVERSE_NUMBERS;
use crate::lists::DeviceList;
use crate::pair_rows::{OWN_NUMBERS, PairRows};
use crate::surface_laws::SurfaceLaws;
use crate::tables::NumberFormat;
use crate::task::KernelTask;

/// Threads of a block and of a row, as in `gpu/kernels/assembly.h`.
const ASSEMBLY_THREADS: usize = 128;
const ROW_LANES: usize = 8;

/// Numbers of a particle in [`NearInFlow::values`]: a load, and a first moment.
pub const IN_FLOW: usize = 6 + 5;

/// Input of an assembly.
#[derive(Debug, Clone, Copy)]
pub struct NearInput<'a> {
    /// Rate of strain of the background: xx, xy, xz, yy and yz.
    pub background: [f64; 5],
    /// Rows of other stiff pairs, and other resistances to own motions.
    pub given: Option<&'a PairRows>,
    /// Forces between surfaces that are added to the loads, if there are any.
    pub surface: Option<&'a SurfaceLaws>,
}

/// Near pairs that were found, and their loads on spheres at rest in the background.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NearInFlow {
    /// Number of stiff and of soft pairs of all particles, each of which counts for both of its particles, with those
    /// that were given.
    pub pairs: [usize; 2],
    /// Load of each particle on the fluid, with forces between surfaces, and its first moment: [`IN_FLOW`] numbers
    /// each.
    pub values: Vec<f64>,
}

impl SplitFarField {
    /// Finds the near pairs of the arranged particles, and assembles the rows of their resistance and the groups of the
    /// preconditioner.
    ///
    /// # Panics
    /// Without [`Self::set_near_tables`].
    pub fn assemble_near(&mut self, input: &NearInput) -> Result<NearInFlow, DeviceError> {
        let reach = self.near.reach.expect("the tables of near pairs are on the device");
        self.task.near_reach = self.bins_within(reach);
        self.task.background = input.background;
        self.take_given(input.given)?;
        let pairs = self.list_near()?;
        self.assemble_rows(pairs)?;
        if let Some(laws) = input.surface {
            self.add_surface_forces(laws, [self.task.in_flow, IN_FLOW as u64])?;
        }
        let values = self.download(self.task.in_flow, IN_FLOW * self.task.particles as usize, NumberFormat::Double)?;
        Ok(NearInFlow { pairs, values })
    }

    /// Copies the rows that the host gives.
    fn take_given(&mut self, given: Option<&PairRows>) -> Result<(), DeviceError> {
        let Self { device, buffers, task, .. } = self;
        (task.given_starts, task.given_others, task.given_numbers, task.given_own) = (0, 0, 0, 0);
        task.given_entries = 0;
        given.map_or(Ok(()), |rows| task.give(&mut buffers.near.given, device.as_mut(), rows))
    }

    /// Counts the stiff and soft pairs of each row, then lists them. Returns their numbers.
    fn list_near(&mut self) -> Result<[usize; 2], DeviceError> {
        let (count, mut totals) = (self.task.particles as usize, [0_usize; 2]);
        for set in 0..2 {
            let on = self.device.as_mut();
            let starts = self.buffers.near.sets[set].starts.reserve(on, 4 * (count + 1))?;
            on.zero(starts, 4 * (count + 1))?;
            self.task.near_starts[set] = starts;
        }
        self.task.near_others = [0; 2];
        self.run_over_particles("find_near", PARTICLE_THREADS)?;
        for set in 0..2 {
            let mut sum = [0_i32];
            let address = self.scan(self.task.near_starts[set], count + 1, 0)?;
            self.device.download(address, bytemuck::cast_slice_mut(&mut sum))?;
            totals[set] = sum[0] as usize;
        }
        for (set, &pairs) in totals.iter().enumerate() {
            let (on, places) = (self.device.as_mut(), &mut self.buffers.near.sets[set]);
            self.task.near_others[set] = places.others.reserve(on, 4 * pairs)?;
            self.task.near_steps[set] = places.steps.reserve(on, 4 * pairs)?;
        }
        self.run_over_particles("find_near", PARTICLE_THREADS)?;
        Ok(totals)
    }

    /// Assembles the rows of pairs that are listed, and the groups of the preconditioner.
    fn assemble_rows(&mut self, [stiff, soft]: [usize; 2]) -> Result<(), DeviceError> {
        let (count, format) = (self.task.particles as usize, self.tables.numbers);
        let Self { device, buffers, task, .. } = self;
        let (on, places) = (device.as_mut(), &mut buffers.near);
        let [of_stiff, of_soft] = &mut places.sets;
        task.reserve_numbers(of_stiff, on, [0, stiff], NumberFormat::Double)?;
        task.reserve_numbers(of_soft, on, [1, soft], format)?;
        task.in_flow = places.in_flow.reserve(on, size_of::<f64>() * IN_FLOW * count)?;
        let task = self.task;
        self.launch_assembly("assemble_stiff", &task)?;
        self.launch_assembly(&format!("assemble_soft_{}", format.suffix()), &task)?;
        self.form_groups(stiff)
    }

    fn launch_assembly(&mut self, kernel: &str, task: &KernelTask) -> Result<(), DeviceError> {
        let blocks = self.particle_blocks(ROW_LANES, ASSEMBLY_THREADS);
        if blocks == 0 {
            return Ok(());
        }
        self.device.launch(&KernelLaunch { kernel, blocks, threads: ASSEMBLY_THREADS }, task)
    }

    /// First moments of lubrication by motions of six numbers a particle: five numbers each.
    pub(crate) fn near_moments(&mut self, motions: &DeviceList) -> Result<Vec<f64>, DeviceError> {
        let numbers = 5 * self.task.particles as usize;
        let image = self.buffers.near.moments.reserve(self.device.as_mut(), size_of::<f64>() * numbers)?;
        let task = KernelTask { direction: motions.address, image, ..self.task };
        self.launch_assembly("moments_stiff", &task)?;
        self.launch_assembly("moments_soft", &task)?;
        self.download(image, numbers, NumberFormat::Double)
    }
}

/// Bytes that the rows of a particle take besides those of its pairs: where rows of both kinds of pairs begin, own
/// resistances, inverses of groups, loads and first moments in the background, and first moments by motions.
pub(crate) const ROW_BYTES: usize = 2 * (4 + 8 * OWN_NUMBERS) + 8 * (INVERSE_NUMBERS + IN_FLOW + 5);
