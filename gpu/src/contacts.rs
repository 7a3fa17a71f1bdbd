//! Contacts of rough spheres that move on a device, see `gpu/kernels/contacts.h`.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::{PARTICLE_THREADS, SplitFarField};
use crate::lists::DeviceList;
use crate::task::{DeviceAddress, KernelTask};
use bytemuck::{Pod, Zeroable};

/// Numbers of a contact in the columns of its state: the id of the other sphere plus one, or 0 for an empty slot; the
/// tangential and the rolling force, the normal force, and the shares of the two springs.
pub const CONTACT_NUMBERS: usize = 10;

/// Resistances of a contact.
const RESISTANCES: usize = 3;

/// Numbers of a load.
const SIX: usize = 6;

/// Law of contacts in the units of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ContactLaw {
    /// Coefficient of friction.
    pub friction: f64,
    /// Height of the asperities of both spheres together, over the mean radius.
    pub roughness: f64,
    /// Stiffness, a force over the square of a length.
    pub stiffness: f64,
    /// Tangential over normal stiffness.
    pub tangential_ratio: f64,
    /// Largest force of rolling resistance over the normal force.
    pub rolling_friction: f64,
    /// Normal force up to which there is no friction.
    pub critical_load: f64,
}

/// Contacts of particles that move on the device: lists in the order of ids, and in the units of the host.
#[derive(Debug, Clone, Copy)]
pub struct ContactInput<'a> {
    /// The law.
    pub law: ContactLaw,
    /// Whether the normal force grows with the power 3/2 of the overlap, instead of in proportion to it.
    pub is_hertz: bool,
    /// Radii by class in the units of the solve.
    pub radii: &'a [f64],
    /// Largest number of contacts of a particle.
    pub slots: usize,
    /// Times over which forces are predicted along the line of centres and across, in the units of the solve.
    pub times: [f64; 2],
    /// Ids of the particles.
    pub ids: &'a [u64],
    /// Positions.
    pub positions: DeviceList,
    /// Expected velocities with that of the background; `None` for those of the background.
    pub expected: Option<DeviceList>,
    /// State at the start of the substep, [`CONTACT_NUMBERS`] a slot; `None` if there were no contacts.
    pub history: Option<DeviceList>,
    /// Velocities and angular velocities of the previous solution relative to the background; `None` for zeros.
    pub previous: Option<[DeviceList; 2]>,
    /// Velocity gradient of the background, row by row.
    pub gradient: [f64; 9],
    /// Gradient of the part of it that expected velocities contain.
    pub carried: [f64; 9],
    /// Factors of velocities and of rates from the units of the host to those of the solve.
    pub factors: [f64; 2],
}

/// Loads of contacts.
#[derive(Debug, Clone, Copy)]
pub struct ContactLoads {
    /// Loads in the units of the solve, six numbers a particle.
    pub list: DeviceList,
    /// Magnitude of the largest number.
    pub largest: f64,
    /// Place, in the order of ids, of the first particle with more contacts than slots, if there is one: then the loads
    /// lack some contacts.
    pub crowded: Option<usize>,
}

/// Arguments with the fields of `gpu/kernels/contacts.h` in the same order.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct ContactArguments {
    positions: DeviceAddress,
    expected: DeviceAddress,
    history: DeviceAddress,
    previous: [DeviceAddress; 2],
    motions: [DeviceAddress; 2],
    found: DeviceAddress,
    steady: DeviceAddress,
    loads: DeviceAddress,
    radii: DeviceAddress,
    lists: [DeviceAddress; 3],
    resistances: DeviceAddress,
    sums: DeviceAddress,
    law: ContactLaw,
    times: [f64; 2],
    reach: f64,
    factors: [f64; 2],
    gradient: [f64; 9],
    carried: [f64; 9],
    slots: i64,
    is_hertz: i64,
}

/// Bytes of the contacts of a particle with this many slots, besides the columns of their states: lists with
/// resistances, loads, and an id.
pub fn contact_bytes(slots: usize) -> usize {
    4 + slots * (4 + 4 + size_of::<f64>() * RESISTANCES) + size_of::<f64>() * SIX + size_of::<u64>()
}

/// Number of sums over all spheres, as in `gpu/kernels/contacts.h`.
const SUMS: usize = 2;

impl SplitFarField {
    /// Finds the contacts of the arranged particles. Returns the known parts of their loads, added to steady loads if
    /// there are any; the springs of later assemblies are theirs too, until particles move.
    pub fn contact_loads(
        &mut self,
        input: &ContactInput,
        steady: Option<DeviceList>,
    ) -> Result<ContactLoads, DeviceError> {
        let count = self.task.particles as usize;
        let list = self.wide_list(SIX * count)?;
        let mut arguments = self.arguments_of(input)?;
        (arguments.steady, arguments.loads) = (steady.map_or(0, |list| list.address), list.address);
        let task = self.contact_task(input, &arguments)?;
        self.near.reach_of_contacts = arguments.reach;
        let mut sums = [0_u64; SUMS];
        let [crowded, largest] = if count == 0 {
            sums
        } else {
            self.device.zero(arguments.sums, size_of_val(&sums))?;
            let task = KernelTask { near_reach: self.bins_within(arguments.reach), ..task };
            let find = format!("find_contacts_{}", self.tables.numbers.suffix());
            self.launch_contacts(&find, &task)?;
            self.launch_contacts("load_contacts", &task)?;
            self.device.download(arguments.sums, bytemuck::cast_slice_mut(&mut sums))?;
            sums
        };
        let crowded = (crowded > 0).then(|| count - crowded as usize);
        Ok(ContactLoads { list, largest: f64::from_bits(largest), crowded })
    }

    /// Stores the states of these contacts at the end of the substep, [`CONTACT_NUMBERS`] a slot, by velocities and
    /// angular velocities of the solution relative to the background.
    pub fn contact_ends(
        &mut self,
        input: &ContactInput,
        motions: [DeviceList; 2],
        found: &DeviceList,
    ) -> Result<(), DeviceError> {
        let arguments = self.arguments_of(input)?;
        let motions = motions.map(|list| list.address);
        let task = self.contact_task(input, &ContactArguments { motions, found: found.address, ..arguments })?;
        self.launch_contacts("end_contacts_all", &task)
    }

    fn launch_contacts(&mut self, kernel: &str, task: &KernelTask) -> Result<(), DeviceError> {
        let (blocks, threads) = (self.particle_blocks(1, PARTICLE_THREADS), PARTICLE_THREADS);
        if blocks == 0 {
            return Ok(());
        }
        self.device.launch(&KernelLaunch { kernel, blocks, threads }, task)
    }

    /// The task with these arguments and the ids of the particles.
    fn contact_task(&mut self, input: &ContactInput, arguments: &ContactArguments) -> Result<KernelTask, DeviceError> {
        let ids = self.place_ids(input.ids)?;
        let contacts = self.buffers.contacts.arguments.fill(self.device.as_mut(), bytemuck::bytes_of(arguments))?;
        Ok(KernelTask { ids, contacts, ..self.task })
    }

    /// Arguments without loads and motions at the end.
    fn arguments_of(&mut self, input: &ContactInput) -> Result<ContactArguments, DeviceError> {
        let &ContactInput { law, radii, slots, times, positions, expected, history, previous, .. } = input;
        let (Self { device, buffers, task, .. }, of) = (self, |list: DeviceList| list.address);
        let (places, on, count) = (&mut buffers.contacts, device.as_mut(), task.particles as usize);
        let mut lists = [0; 3];
        for ((list, buffer), each) in lists.iter_mut().zip(&mut places.lists).zip([1, slots, slots]) {
            *list = buffer.reserve(on, size_of::<i32>() * each * count)?;
        }
        let largest = radii.iter().copied().fold(0.0, f64::max);
        Ok(ContactArguments {
            positions: of(positions),
            expected: expected.map_or(0, of),
            history: history.map_or(0, of),
            previous: previous.map_or([0; 2], |lists| lists.map(of)),
            radii: places.radii.fill(on, bytemuck::cast_slice(radii))?,
            lists,
            resistances: places.resistances.reserve(on, size_of::<f64>() * RESISTANCES * slots * count)?,
            sums: places.sums.reserve(on, size_of::<[u64; SUMS]>())?,
            law,
            times,
            reach: 2.0 * largest * (1.0 + 0.5 * law.roughness),
            factors: input.factors,
            gradient: input.gradient,
            carried: input.carried,
            slots: slots as i64,
            is_hertz: i64::from(input.is_hertz),
            ..ContactArguments::zeroed()
        })
    }
}
