//! Pairs of spheres that overlap, or nearly, counted on a device, see `gpu/kernels/overlaps.h`.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::{PARTICLE_THREADS, SplitFarField};
use crate::task::KernelTask;

/// Distances of centres for all ordered pairs of classes of radius, those of the first class first: at contact, and at
/// the minimum gap.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OverlapLimits(pub Vec<[f64; 2]>);

/// Pairs of spheres that are too close.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CloseSpheres {
    /// Number of pairs that overlap.
    pub overlapping: u64,
    /// Number of pairs below the minimum gap.
    pub at_minimum_gap: u64,
    /// Deepest overlap; 0 without overlaps.
    pub depth: f64,
}

impl SplitFarField {
    /// Pairs of the arranged particles that are closer than some limits.
    pub fn count_overlaps(&mut self, limits: &OverlapLimits) -> Result<CloseSpheres, DeviceError> {
        let (blocks, threads) = (self.particle_blocks(1, PARTICLE_THREADS), PARTICLE_THREADS);
        if blocks == 0 {
            return Ok(CloseSpheres::default());
        }
        let (mut sums, distances) = ([0_u64; 3], limits.0.as_flattened());
        let Self { device, buffers, .. } = self;
        let list_x = buffers.overlap_limits.fill(device.as_mut(), bytemuck::cast_slice(distances))?;
        let list_y = buffers.overlaps.reserve(device.as_mut(), size_of_val(&sums))?;
        device.zero(list_y, size_of_val(&sums))?;
        let near_reach = self.bins_within(distances.iter().copied().fold(0.0, f64::max));
        let task = KernelTask { list_x, list_y, near_reach, ..self.task };
        let kernel = &format!("overlapping_pairs_{}", self.tables.numbers.suffix());
        self.device.launch(&KernelLaunch { kernel, blocks, threads }, &task)?;
        self.device.download(list_y, bytemuck::cast_slice_mut(&mut sums))?;
        let [overlapping, at_minimum_gap, depth] = sums;
        // Each pair has been counted for both of its spheres.
        let [overlapping, at_minimum_gap] = [overlapping, at_minimum_gap].map(|count| count / 2);
        Ok(CloseSpheres { overlapping, at_minimum_gap, depth: f64::from_bits(depth) })
    }
}
