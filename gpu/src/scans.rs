//! Sums of counts on a device.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::SplitFarField;
use crate::task::{DeviceAddress, KernelTask};

/// Threads of a block, as in `gpu/kernels/bins.h`.
const SCAN: usize = 256;

impl SplitFarField {
    /// Replaces a list of counts by the sums of those before each. The sum of all becomes one of the counts if it has a
    /// place there.
    pub(crate) fn scan(&mut self, list: DeviceAddress, count: usize, place: Option<usize>) -> Result<(), DeviceError> {
        let sum = place.map(|place| self.task.counts + 4 * place as u64);
        self.scan_at(list, count, sum, 0)
    }

    /// [`Self::scan`] at a level of its recursion.
    fn scan_at(
        &mut self,
        list: DeviceAddress,
        count: usize,
        sum: Option<DeviceAddress>,
        level: usize,
    ) -> Result<(), DeviceError> {
        let blocks = count.div_ceil(SCAN);
        let of_level = self.buffers.scans[level].reserve(self.device.as_mut(), 4 * blocks)?;
        let scan_totals = if blocks == 1 { sum.unwrap_or(of_level) } else { of_level };
        let task = KernelTask { scanned: list, scan_totals, scan_count: count as i32, ..self.task };
        self.device.launch(&KernelLaunch { kernel: "scan_blocks", blocks, threads: SCAN }, &task)?;
        if blocks == 1 {
            return Ok(());
        }
        self.scan_at(of_level, blocks, sum, level + 1)?;
        self.device.launch(&KernelLaunch { kernel: "scan_add", blocks, threads: SCAN }, &task)
    }

    /// Some of the counts, from one on.
    pub(crate) fn counts<const N: usize>(&mut self, first: usize) -> Result<[usize; N], DeviceError> {
        let mut counts = [0_i32; N];
        let place = self.task.counts + 4 * first as u64;
        self.device.download(place, bytemuck::cast_slice_mut(&mut counts))?;
        Ok(counts.map(|count| count as usize))
    }
}
