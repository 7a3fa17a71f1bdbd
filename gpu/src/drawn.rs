//! Random motions of the fluid at particles that move on a device, see `gpu/kernels/drawn.h`.

use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use crate::lists::DeviceList;
use crate::task::{DeviceAddress, KernelTask};
use bytemuck::{Pod, Zeroable};

/// Lists for random motions, in the order of ids and in the units of the host.
#[derive(Debug, Clone, Copy)]
pub struct DrawnLists {
    /// Velocities, angular velocities and rates of strain, eleven numbers a particle.
    pub ambient: DeviceList,
    /// The velocities with those of the background flow.
    pub velocities: DeviceList,
    /// Positions.
    pub positions: DeviceList,
    /// Factors of velocities, and of angular velocities and rates of strain, from the units of the far field.
    pub factors: [f64; 2],
    /// Velocity gradient of the background, row by row.
    pub gradient: [f64; 9],
}

/// Arguments with the fields of `gpu/kernels/drawn.h` in the same order.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct DrawnMotion {
    ambient: DeviceAddress,
    velocities: DeviceAddress,
    positions: DeviceAddress,
    factors: [f64; 2],
    gradient: [f64; 9],
}

impl SplitFarField {
    /// Stores the motions that were drawn last in lists on the device.
    pub fn store_drawn(&mut self, lists: &DrawnLists) -> Result<(), DeviceError> {
        let &DrawnLists { ambient, velocities, positions, factors, gradient } = lists;
        let [ambient, velocities, positions] = [ambient, velocities, positions].map(|list| list.address);
        let arguments = DrawnMotion { ambient, velocities, positions, factors, gradient };
        let drawn = self.buffers.drawn.fill(self.device.as_mut(), bytemuck::bytes_of(&arguments))?;
        let task = KernelTask { drawn, ..self.task };
        self.launch_particles(&format!("drawn_motions_{}", self.tables.numbers.suffix()), &task)
    }

    /// Place of the ids of the particles, which are copied unless they are there.
    pub(crate) fn place_ids(&mut self, ids: &[u64]) -> Result<DeviceAddress, DeviceError> {
        let of_ids = &mut self.buffers.names[0];
        if !self.has_ids {
            of_ids.fill(self.device.as_mut(), bytemuck::cast_slice(ids))?;
            self.has_ids = true;
        }
        Ok(of_ids.address())
    }
}
