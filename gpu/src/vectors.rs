//! Vectors of an iteration in the memory of a device.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::SplitFarField;
use crate::groups::group_blocks;
use crate::lists::{DeviceList, MotionLists};
use crate::numbers::COUPLED_SUMS;
use crate::pair_rows::{PAIR_SUMS, ROW_LANES};
use crate::tables::NumberFormat;
use crate::task::{DeviceAddress, KernelTask};

/// Threads of a block, as in `gpu/kernels/vectors.h`.
pub(crate) const SUM_THREADS: usize = 256;

impl SplitFarField {
    /// A list of this many values in the precision of the grid, which are undefined.
    pub fn list(&mut self, count: usize) -> Result<DeviceList, DeviceError> {
        self.list_in(self.tables.numbers, count)
    }

    /// A list of this many values in `f64`, which are undefined.
    pub fn wide_list(&mut self, count: usize) -> Result<DeviceList, DeviceError> {
        self.list_in(NumberFormat::Double, count)
    }

    /// A list like another, of undefined values.
    pub fn list_like(&mut self, list: &DeviceList) -> Result<DeviceList, DeviceError> {
        self.list_in(list.numbers, list.count)
    }

    fn list_in(&mut self, numbers: NumberFormat, count: usize) -> Result<DeviceList, DeviceError> {
        let is_like = |list: &DeviceList| list.count == count && list.numbers == numbers;
        let like = self.spare.iter().enumerate().filter(|(_, list)| is_like(list));
        // The first one, so that the same requests get the same memory, and recordings remain valid.
        if let Some((place, _)) = like.min_by_key(|(_, list)| list.address) {
            return Ok(self.spare.swap_remove(place));
        }
        let address = self.device.allocate(count * numbers.size())?;
        Ok(DeviceList { address, count, numbers })
    }

    /// Copies values to the start of a list.
    pub fn fill(&mut self, list: &DeviceList, values: &[f64]) -> Result<(), DeviceError> {
        self.device.upload(list.address, &list.numbers.bytes_of(values))
    }

    /// The values of a list.
    pub fn values_of(&mut self, list: &DeviceList) -> Result<Vec<f64>, DeviceError> {
        self.download(list.address, list.count, list.numbers)
    }

    /// Lists for the motions of all particles.
    pub fn motion_lists(&mut self) -> Result<MotionLists, DeviceError> {
        let count = self.task.particles as usize;
        Ok([self.list(3 * count)?, self.list(3 * count)?, self.list(5 * count)?])
    }

    /// Releases a list. Its memory is kept for another of as many values.
    pub fn release(&mut self, list: &DeviceList) {
        self.spare.push(*list);
    }

    /// Releases the memory of lists that were released.
    pub(crate) fn release_spare(&mut self) {
        for list in std::mem::take(&mut self.spare) {
            self.device.release(list.address);
        }
    }

    /// Takes room for the sums of all blocks of kernels that work on this many particles.
    pub(crate) fn reserve_sums(&mut self, particles: usize) -> Result<(), DeviceError> {
        let [blocks, of_rows] = [1, ROW_LANES].map(|lanes| (lanes * particles).div_ceil(SUM_THREADS));
        let lists = [COUPLED_SUMS * blocks, of_rows.max(PAIR_SUMS * group_blocks(particles)), of_rows];
        for (buffer, count) in self.buffers.sums.iter_mut().zip(lists) {
            buffer.reserve(self.device.as_mut(), size_of::<f64>() * count)?;
        }
        Ok(())
    }

    /// Place of the sums of blocks, in one of three lists.
    pub(crate) fn sums(&self, list: usize) -> DeviceAddress {
        self.buffers.sums[list].address()
    }

    /// Adds up the sums of blocks in lists one after the other, to sums at an address.
    pub(crate) fn launch_sums(
        &mut self,
        list_sums: DeviceAddress,
        blocks: usize,
        lists: usize,
        totals: DeviceAddress,
    ) -> Result<(), DeviceError> {
        let task = KernelTask { list_sums, totals, list_size: blocks as i64, ..self.task };
        self.launch_vectors("sum_up", lists, &task)
    }

    pub(crate) fn blocks(&self) -> usize {
        (self.task.particles as usize).div_ceil(SUM_THREADS)
    }

    /// Runs a kernel of vectors, unless there is nothing to do.
    pub(crate) fn launch_vectors(&mut self, kernel: &str, blocks: usize, task: &KernelTask) -> Result<(), DeviceError> {
        if blocks == 0 {
            return Ok(());
        }
        self.device.launch(&KernelLaunch { kernel, blocks, threads: SUM_THREADS }, task)
    }
}
