//! Known solutions in columns on a device: their residual, and their change where spheres have moved, see
//! `gpu/kernels/known.h`.

use crate::coupled::{CoupledVectors, KnownInput, StartInput};
use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use crate::history::ColumnUnits;
use crate::lists::DeviceList;
use crate::task::{DeviceAddress, KernelTask};
use bytemuck::{Pod, Zeroable};

/// A known solution: lists in the order of ids, and in the units of the host.
#[derive(Debug, Clone, Copy)]
pub struct KnownLists {
    /// Velocities and angular velocities relative to the background.
    pub motions: [DeviceList; 2],
    /// Stresslets of the far field.
    pub far_stresslets: DeviceList,
    /// Forces and torques.
    pub loads: [DeviceList; 2],
    /// Total stresslets.
    pub stresslets: DeviceList,
    /// Motions of the fluid for which the solution is exact, eleven numbers a particle.
    pub ambient: DeviceList,
    /// Units of the host over those of the solve.
    pub units: ColumnUnits,
}

/// Changes of a solution over a divisor: lists in the order of ids, and in the units of the host.
#[derive(Debug, Clone, Copy)]
pub struct ChangeColumns {
    /// Of velocities.
    pub velocities: DeviceList,
    /// Of total stresslets.
    pub stresslets: DeviceList,
    /// The divisor.
    pub divisor: f64,
}

/// Arguments with the fields of `gpu/kernels/known.h` in the same order.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct KnownColumns {
    motions: [DeviceAddress; 2],
    far_stresslets: DeviceAddress,
    loads: [DeviceAddress; 2],
    stresslets: DeviceAddress,
    ambient: DeviceAddress,
    velocity_changes: DeviceAddress,
    stresslet_changes: DeviceAddress,
    divisor: f64,
    velocity: f64,
    rate: f64,
    torque: f64,
    is_complete: i64,
}

impl KnownColumns {
    fn new(known: &KnownLists) -> Self {
        let ColumnUnits { velocity, rate, torque } = known.units;
        Self {
            motions: known.motions.map(|list| list.address),
            far_stresslets: known.far_stresslets.address,
            loads: known.loads.map(|list| list.address),
            stresslets: known.stresslets.address,
            ambient: known.ambient.address,
            velocity,
            rate,
            torque,
            ..Self::zeroed()
        }
    }
}

impl SplitFarField {
    /// Vectors of a known solution: motions and minus the stresslets, loads, and motions of the fluid, if there are to
    /// be any. Without these, loads are not known yet: they are those in a list, if there is one, and those of near
    /// pairs in the background, and are stored.
    pub fn load_known(
        &mut self,
        lists: &KnownLists,
        given: Option<DeviceList>,
        start: &StartInput,
        known: &KnownInput,
    ) -> Result<(), DeviceError> {
        let is_complete = i64::from(known.ambient.is_some());
        let place = self.place_known(&KnownColumns { is_complete, ..KnownColumns::new(lists) })?;
        let [unknowns, image, list_y] = [start.motions, known.loads, start.moments].map(|list| list.address);
        let [ambient, residual] = [given, known.ambient].map(|list| list.map_or(0, |list| list.address));
        let task = KernelTask { known: place, unknowns, image, list_y, ambient, residual, ..self.task };
        self.launch_particles("load_known_all", &task)
    }

    /// Stores the motions of the fluid for which a known solution is exact, from its residual, and its total
    /// stresslets.
    pub fn store_residual(
        &mut self,
        lists: &KnownLists,
        residual: &DeviceList,
        start: &StartInput,
    ) -> Result<(), DeviceError> {
        let list_y = self.place_of_moments()?;
        self.launch_moments(&start.motions, list_y)?;
        let known = self.place_known(&KnownColumns::new(lists))?;
        let [residual, list_x] = [*residual, start.moments].map(|list| list.address);
        self.launch_particles("store_residual_all", &KernelTask { list_x, list_y, residual, known, ..self.task })
    }

    /// Stores the change of a known solution after a change of the unknowns from a start, see
    /// [`Self::copy_changed`].
    pub fn store_change(
        &mut self,
        lists: &KnownLists,
        changes: &ChangeColumns,
        at: &CoupledVectors,
        start: &StartInput,
    ) -> Result<(), DeviceError> {
        let (changed, list_x) = self.gather_changed(at, start)?;
        let (velocity_changes, stresslet_changes) = (changes.velocities.address, changes.stresslets.address);
        let arguments =
            KnownColumns { velocity_changes, stresslet_changes, divisor: changes.divisor, ..KnownColumns::new(lists) };
        let known = self.place_known(&arguments)?;
        let task = KernelTask { known, direction: changed.address, list_x, ..self.task };
        self.launch_particles("store_change_all", &task)?;
        self.release(&changed);
        Ok(())
    }

    fn place_known(&mut self, arguments: &KnownColumns) -> Result<DeviceAddress, DeviceError> {
        self.buffers.known.fill(self.device.as_mut(), bytemuck::bytes_of(arguments))
    }
}
