//! Search for near pairs and assembly of their resistance on a device, see `gpu/kernels/assembly.h`.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::{PARTICLE_THREADS, SplitFarField};
use crate::groups::ROUNDS;
use crate::lists::DeviceList;
use crate::numbers::KernelNumbers;
use crate::pair_rows::{IN_FLOW, OWN_NUMBERS, PAIR_NUMBERS, PairRows, ROW_LANES, WALL_NUMBERS};
use crate::predicted::PredictedMotion;
use crate::repeated::CommandList;
use crate::surface_laws::SurfaceLaws;
use crate::tables::NumberFormat;
use crate::task::{DeviceAddress, KernelTask};

/// Threads of a block, as in `gpu/kernels/assembly.h`.
const ASSEMBLY_THREADS: usize = 128;

/// Input of an assembly.
#[derive(Debug, Clone, Copy, Default)]
pub struct NearInput<'a> {
    /// Rate of strain of the background at `z = 0`: xx, xy, xz, yy and yz.
    pub background: [f64; 5],
    /// Derivatives of its components xz and yz with respect to z, in boxes that do not repeat along z.
    pub slope: [f64; 2],
    /// Rows of other stiff pairs, and other resistances to own motions.
    pub given: Option<&'a PairRows>,
    /// Forces between surfaces that are added to the loads, if there are any.
    pub surface: Option<&'a SurfaceLaws>,
    /// Whether pairs have the springs of the contacts that were found last, which are there still.
    pub are_touching: bool,
    /// Predicted motions, for which implicit forces between surfaces are taken, if there are any.
    pub predicted: Option<PredictedMotion>,
}

impl SplitFarField {
    /// Finds the near pairs of the arranged particles, assembles the rows of their resistance, and forms the groups of
    /// the preconditioner. Returns the numbers of stiff and of soft pairs of all particles, each of which counts for
    /// both of its particles, with those that were given.
    ///
    /// # Panics
    /// Without [`Self::set_near_tables`].
    pub fn assemble_near(&mut self, input: &NearInput) -> Result<[usize; 2], DeviceError> {
        let reach = self.take_springs(input)?;
        self.task.near_reach = self.bins_within(reach);
        self.take_given(input.given)?;
        let pairs = self.count_near()?;
        self.reserve_rows(pairs)?;
        self.reserve_groups()?;
        let given_entries = input.given.map_or(0, |rows| rows.others.len() as i64);
        let near_entries = pairs.map(|count| count as i64);
        let &NearInput { background, slope, .. } = input;
        self.set_numbers(&KernelNumbers { background, slope, near_entries, given_entries, ..self.numbers })?;
        self.assemble_rows()?;
        if let Some(laws) = input.surface {
            self.add_surface_forces(laws, [self.task.in_flow, IN_FLOW as u64])?;
        }
        Ok(pairs)
    }

    /// Load of each particle on the fluid by near pairs at rest in the background, with forces between surfaces, and
    /// its first moment: [`IN_FLOW`] numbers each.
    pub fn near_in_flow(&mut self) -> Result<Vec<f64>, DeviceError> {
        self.download(self.task.in_flow, IN_FLOW * self.task.particles as usize, NumberFormat::Double)
    }

    /// Takes the springs of an assembly. Returns the distance within which near pairs are.
    fn take_springs(&mut self, input: &NearInput) -> Result<f64, DeviceError> {
        let mut reach = self.near.reach.expect("the tables of near pairs are on the device");
        (self.task.contacts, self.task.predicted) = (0, 0);
        if input.are_touching {
            self.task.contacts = self.buffers.contacts.address();
            reach = reach.max(self.near.reach_of_contacts);
        }
        let implicit = input.surface.filter(|laws| laws.implicit_reach() > 0.0);
        if let Some((predicted, laws)) = input.predicted.as_ref().zip(implicit) {
            self.task.predicted = self.place_predicted(predicted, laws)?;
            reach = reach.max(laws.implicit_reach());
        }
        let has_springs = self.task.contacts != 0 || self.task.predicted != 0;
        assert!(!has_springs || self.task.near_kinds != 0, "the tables have the pairs of classes of springs");
        Ok(reach)
    }

    /// Copies the rows that the host gives.
    fn take_given(&mut self, given: Option<&PairRows>) -> Result<(), DeviceError> {
        let Self { device, buffers, task, .. } = self;
        (task.given_starts, task.given_others, task.given_numbers) = (0, 0, 0);
        (task.given_own, task.given_at_walls) = (0, 0);
        given.map_or(Ok(()), |rows| task.give(&mut buffers.near.given, device.as_mut(), rows))
    }

    /// Counts the stiff and soft pairs of each row. Returns their numbers.
    fn count_near(&mut self) -> Result<[usize; 2], DeviceError> {
        let count = self.task.particles as usize;
        for set in 0..2 {
            let on = self.device.as_mut();
            let starts = self.buffers.near.sets[set].starts.reserve(on, 4 * (count + 1))?;
            on.zero(starts, 4 * (count + 1))?;
            self.task.near_starts[set] = starts;
        }
        self.task.near_others = [0; 2];
        self.repeat(CommandList::CountPairs, &[], |field| {
            field.run_over_particles("find_near", PARTICLE_THREADS)?;
            (0..2).try_for_each(|set| field.scan(field.task.near_starts[set], count + 1, Some(1 + set)))
        })?;
        self.counts(1)
    }

    /// Takes room for this many stiff and soft pairs.
    fn reserve_rows(&mut self, pairs: [usize; 2]) -> Result<(), DeviceError> {
        let (count, formats) = (self.task.particles as usize, [NumberFormat::Double, self.tables.numbers]);
        let Self { device, buffers, task, .. } = self;
        let (on, places) = (device.as_mut(), &mut buffers.near);
        for (set, rows) in places.sets.iter_mut().enumerate() {
            let numbers = PAIR_NUMBERS * pairs[set] * formats[set].size();
            task.near_others[set] = rows.others.reserve(on, 4 * pairs[set])?;
            task.near_steps[set] = rows.steps.reserve(on, 4 * pairs[set])?;
            task.near_numbers[set] = rows.numbers.reserve(on, numbers)?;
            task.near_own[set] = rows.own.reserve(on, size_of::<f64>() * OWN_NUMBERS * count)?;
        }
        task.in_flow = places.in_flow.reserve(on, size_of::<f64>() * IN_FLOW * count)?;
        Ok(())
    }

    /// Lists pairs, assembles their rows, and forms groups.
    fn assemble_rows(&mut self) -> Result<(), DeviceError> {
        let soft = format!("assemble_soft_{}", self.tables.numbers.suffix());
        self.repeat(CommandList::Assemble, &[], |field| {
            let task = field.task;
            field.run_over_particles("find_near", PARTICLE_THREADS)?;
            field.launch_assembly("assemble_stiff", &task)?;
            field.launch_assembly(&soft, &task)?;
            field.form_groups(ROUNDS)?;
            field.invert_groups()
        })
    }

    fn launch_assembly(&mut self, kernel: &str, task: &KernelTask) -> Result<(), DeviceError> {
        let blocks = self.particle_blocks(ROW_LANES, ASSEMBLY_THREADS);
        if blocks == 0 {
            return Ok(());
        }
        self.device.launch(&KernelLaunch { kernel, blocks, threads: ASSEMBLY_THREADS }, task)
    }

    /// Place of the first moments of lubrication, five numbers a particle.
    pub(crate) fn place_of_moments(&mut self) -> Result<DeviceAddress, DeviceError> {
        let bytes = size_of::<f64>() * MOMENTS * self.task.particles as usize;
        self.buffers.near.moments.reserve(self.device.as_mut(), bytes)
    }

    /// First moments of lubrication by motions of six numbers a particle.
    pub(crate) fn launch_moments(&mut self, motions: &DeviceList, image: DeviceAddress) -> Result<(), DeviceError> {
        let task = KernelTask { direction: motions.address, image, ..self.task };
        self.launch_assembly("moments_stiff", &task)?;
        self.launch_assembly("moments_soft", &task)
    }
}

/// Numbers of the first moment of a particle.
pub(crate) const MOMENTS: usize = 5;

/// Bytes that the rows of a particle take besides those of its pairs: where rows of both kinds of pairs begin, own
/// resistances, loads and first moments in the background, and first moments by motions.
pub(crate) const ROW_BYTES: usize = 2 * (4 + 8 * OWN_NUMBERS) + 8 * (IN_FLOW + MOMENTS);

/// Bytes that the rows of a particle take that the host gives, without pairs.
pub(crate) const GIVEN_BYTES: usize = 4 + 8 * (OWN_NUMBERS + WALL_NUMBERS);
