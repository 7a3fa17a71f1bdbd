//! Copies of loads, motions and tables between the host and a device.

use crate::device::DeviceError;
use crate::far_field::{DeviceLoads, DeviceMotion, Orders, SplitFarField};
use crate::tables::{AMPLITUDES, GridSolve, NumberFormat};
use crate::task::{DeviceAddress, KernelTask};
use bytemuck::Pod;
use domain::parallel::mapped;

impl SplitFarField {
    /// Copies the tables of the solve on the grid.
    pub(crate) fn copy_solve(&mut self) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, .. } = self;
        let ([first, second, third, fourth], on) = (&mut buffers.of_solve, device.as_mut());
        match &tables.solve {
            GridSolve::Periodic => {}
            GridSolve::Unbounded(kernel) => {
                task.free_kernel = first.fill(on, &tables.numbers.bytes_of(kernel))?;
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
        let (numbers, on) = (tables.numbers, device.as_mut());
        let addresses = [&mut task.forces, &mut task.torques, &mut task.stresslets];
        let lists = [loads.forces, loads.torques, loads.stresslets];
        for ((address, list), buffer) in addresses.into_iter().zip(lists).zip(&mut buffers.loads) {
            *address = if list.is_empty() { 0 } else { buffer.fill(on, &numbers.bytes_of(list))? };
        }
        self.place_motions([orders.velocities, orders.gradients])
    }

    /// Takes room for loads of all particles that kernels set: forces, and dipoles if there are any.
    pub(crate) fn place_loads(&mut self, has_dipoles: bool) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, .. } = self;
        let (values, on) = (task.particles as usize * tables.numbers.size(), device.as_mut());
        let [forces, torques, stresslets] = &mut buffers.loads;
        task.forces = forces.reserve(on, 3 * values)?;
        task.torques = if has_dipoles { torques.reserve(on, 3 * values)? } else { 0 };
        task.stresslets = if has_dipoles { stresslets.reserve(on, 5 * values)? } else { 0 };
        Ok(())
    }

    /// Takes room for velocities and for gradients of all particles, if they are asked for.
    pub(crate) fn place_motions(&mut self, [has_velocities, has_gradients]: [bool; 2]) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, .. } = self;
        let (values, on) = (task.particles as usize * tables.numbers.size(), device.as_mut());
        let [velocities, turns, strains] = &mut buffers.motions;
        task.velocities = if has_velocities { velocities.reserve(on, 3 * values)? } else { 0 };
        task.angular_velocities = if has_gradients { turns.reserve(on, 3 * values)? } else { 0 };
        task.strain_rates = if has_gradients { strains.reserve(on, 5 * values)? } else { 0 };
        Ok(())
    }

    /// Motions on the device, of the particles whose motions are wanted.
    pub fn copy_motion(&mut self) -> Result<DeviceMotion, DeviceError> {
        let KernelTask { velocities, angular_velocities, strain_rates, owned, .. } = self.task;
        let lists = [(velocities, 3), (angular_velocities, 3), (strain_rates, 5)];
        let placed = lists.map(|(address, each)| (address, if address == 0 { 0 } else { each * owned as usize }));
        let [velocities, angular_velocities, strain_rates] = self.download_lists(placed, self.tables.numbers)?;
        Ok(DeviceMotion { velocities, angular_velocities, strain_rates })
    }

    /// This many numbers at an address.
    pub(crate) fn download(
        &mut self,
        address: DeviceAddress,
        count: usize,
        numbers: NumberFormat,
    ) -> Result<Vec<f64>, DeviceError> {
        self.download_lists([(address, count)], numbers).map(|[values]| values)
    }

    /// Lists at addresses, by their numbers of values. The host waits once for all of them.
    pub(crate) fn download_lists<const N: usize>(
        &mut self,
        lists: [(DeviceAddress, usize); N],
        numbers: NumberFormat,
    ) -> Result<[Vec<f64>; N], DeviceError> {
        match numbers {
            NumberFormat::Single => {
                let lists = self.download_as::<f32, N>(lists)?;
                Ok(lists.map(|values| mapped(&values, |&value| f64::from(value))))
            }
            NumberFormat::Double => self.download_as(lists),
        }
    }

    /// The same as values of a type.
    fn download_as<T: Pod, const N: usize>(
        &mut self,
        lists: [(DeviceAddress, usize); N],
    ) -> Result<[Vec<T>; N], DeviceError> {
        let mut values = lists.map(|(_, count)| vec![T::zeroed(); count]);
        let filled = lists.iter().zip(&mut values).filter(|(_, values)| !values.is_empty());
        let mut parts: Vec<(DeviceAddress, &mut [u8])> =
            filled.map(|(&(address, _), values)| (address, bytemuck::cast_slice_mut(values))).collect();
        if !parts.is_empty() {
            self.device.download_all(&mut parts)?;
        }
        Ok(values)
    }
}
