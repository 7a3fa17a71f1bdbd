//! Copies of loads, motions and tables between the host and a device.

use crate::device::DeviceError;
use crate::far_field::{DeviceLoads, DeviceMotion, Orders, SplitFarField};
use crate::tables::{AMPLITUDES, GridSolve, NumberFormat};
use crate::task::KernelTask;

impl SplitFarField {
    /// Copies the tables of the solve on the grid.
    pub(crate) fn copy_solve(&mut self) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, .. } = self;
        let ([first, second, third, fourth], on) = (&mut buffers.of_solve, device.as_mut());
        match &tables.solve {
            GridSolve::Periodic => {}
            GridSolve::Unbounded(kernel) => {
                task.free_kernel = first.fill(on, &tables.numbers.bytes_of(kernel.iter().copied()))?;
            }
            GridSolve::Channel(channel) => {
                let columns = channel.columns_of(tables.grid, &tables.share.own_modes());
                task.channel_columns = first.fill(on, bytemuck::cast_slice(&columns))?;
                task.channel_planes = second.fill(on, bytemuck::cast_slice(&channel.mean_planes))?;
                task.channel_mean = third.fill(on, bytemuck::cast_slice(&channel.mean_kernel))?;
                let amplitudes = AMPLITUDES * tables.columns() + 6;
                task.channel_amplitudes = fourth.reserve(on, amplitudes * size_of::<f64>())?;
            }
        }
        Ok(())
    }

    pub(crate) fn copy_loads(&mut self, loads: &DeviceLoads, orders: &Orders) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, .. } = self;
        let (numbers, count, on) = (tables.numbers, task.particles as usize, device.as_mut());
        let addresses = [&mut task.forces, &mut task.torques, &mut task.stresslets];
        let lists = [loads.forces, loads.torques, loads.stresslets];
        for ((address, list), buffer) in addresses.into_iter().zip(lists).zip(&mut buffers.loads) {
            *address = if list.is_empty() { 0 } else { buffer.fill(on, &numbers.bytes_of(list.iter().copied()))? };
        }
        let [velocities, turns, strains] = &mut buffers.motions;
        task.velocities = if orders.velocities { velocities.reserve(on, 3 * count * numbers.size())? } else { 0 };
        task.angular_velocities = if orders.gradients { turns.reserve(on, 3 * count * numbers.size())? } else { 0 };
        task.strain_rates = if orders.gradients { strains.reserve(on, 5 * count * numbers.size())? } else { 0 };
        Ok(())
    }

    pub(crate) fn copy_motion(&mut self) -> Result<DeviceMotion, DeviceError> {
        let KernelTask { velocities, angular_velocities, strain_rates, .. } = self.task;
        Ok(DeviceMotion {
            velocities: self.values(velocities, 3)?,
            angular_velocities: self.values(angular_velocities, 3)?,
            strain_rates: self.values(strain_rates, 5)?,
        })
    }

    /// Values of each particle whose motion is wanted at an address; none at 0.
    fn values(&mut self, address: u64, each: usize) -> Result<Vec<f64>, DeviceError> {
        let count = if address == 0 { 0 } else { each * self.task.owned as usize };
        self.download(address, count, self.tables.numbers)
    }

    pub(crate) fn download(
        &mut self,
        address: u64,
        count: usize,
        numbers: NumberFormat,
    ) -> Result<Vec<f64>, DeviceError> {
        let mut bytes = vec![0; count * numbers.size()];
        if count > 0 {
            self.device.download(address, &mut bytes)?;
        }
        Ok(numbers.values_of(&bytes))
    }
}
