//! Images of particles in walls on a device.

use crate::device::DeviceError;
use crate::far_field::SplitFarField;

/// Threads of a block and of a particle, as in `gpu/kernels/images.h`.
const IMAGE_THREADS: usize = 128;
const IMAGE_LANES: usize = 8;

/// Images that act on particles, by rows in the order of the host.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ImageLists {
    /// First image of each row, and the end of the last one.
    pub starts: Vec<i32>,
    /// Row of the source, and twice the number of the block, plus one if the block is for the two in this order.
    pub images: Vec<[i32; 2]>,
    /// Matrices by rows from force and dipole to velocity and gradient, the tensors column by column, for viscosity 1.
    pub blocks: Vec<[[f64; 12]; 12]>,
}

impl SplitFarField {
    /// Sets the images that act on the arranged particles.
    pub fn set_images(&mut self, lists: &ImageLists) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, .. } = self;
        let ([starts, images, blocks], on) = (&mut buffers.images, device.as_mut());
        task.image_starts = starts.fill(on, bytemuck::cast_slice(&lists.starts))?;
        task.images = images.fill(on, bytemuck::cast_slice(&lists.images))?;
        task.image_blocks = blocks.fill(on, &tables.numbers.bytes_of(lists.blocks.as_flattened().as_flattened()))?;
        Ok(())
    }

    /// Adds the motions by images, if there are any, to those of the particles.
    pub(crate) fn add_images(&mut self) -> Result<(), DeviceError> {
        if self.task.image_starts == 0 {
            return Ok(());
        }
        let name = format!("image_motions_{}", self.tables.numbers.suffix());
        self.launch(&name, self.particle_blocks(IMAGE_LANES, IMAGE_THREADS), IMAGE_THREADS)
    }
}
