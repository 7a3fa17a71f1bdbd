//! Forces between the surfaces of spheres on a device, see `gpu/kernels/surface.h`.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::{PARTICLE_THREADS, SplitFarField};
use crate::surface_laws::SurfaceLaws;
use crate::tables::NumberFormat;
use crate::task::{DeviceAddress, KernelTask};

impl SplitFarField {
    /// Forces of all pairs on the arranged particles, three numbers each.
    pub fn surface_forces(&mut self, laws: &SurfaceLaws) -> Result<Vec<f64>, DeviceError> {
        // In the place of the records of an evaluation, which are larger.
        self.reserve_records()?;
        let (list, numbers) = (self.task.records, 3 * self.task.particles as usize);
        self.device.zero(list, numbers * size_of::<f64>())?;
        self.add_surface_forces(laws, [list, 3])?;
        self.download(list, numbers, NumberFormat::Double)
    }

    /// Adds these forces to the first three numbers of each particle in a list of some numbers a particle.
    pub(crate) fn add_surface_forces(
        &mut self,
        laws: &SurfaceLaws,
        [list, each]: [DeviceAddress; 2],
    ) -> Result<(), DeviceError> {
        self.copy_laws(laws)?;
        let (blocks, threads) = (self.particle_blocks(1, PARTICLE_THREADS), PARTICLE_THREADS);
        if blocks == 0 {
            return Ok(());
        }
        let kernel = &format!("surface_forces_{}", self.tables.numbers.suffix());
        let task = KernelTask { image: list, list_size: each as i64, ..self.task };
        self.device.launch(&KernelLaunch { kernel, blocks, threads }, &task)
    }

    /// Copies laws to the device, unless they are there.
    pub(crate) fn copy_laws(&mut self, laws: &SurfaceLaws) -> Result<(), DeviceError> {
        if self.surface_laws.as_ref() != Some(laws) {
            let Self { device, buffers, task, .. } = self;
            task.surface_laws = buffers.surface_laws.fill(device.as_mut(), bytemuck::cast_slice(&laws.of_pairs))?;
            task.surface_count = laws.count as i32;
            self.surface_laws = Some(laws.clone());
        }
        let reach = laws.of_pairs.iter().map(|law| law.reach).fold(0.0, f64::max);
        self.task.surface_reach = self.bins_within(reach);
        Ok(())
    }
}
