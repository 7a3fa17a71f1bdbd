//! Products and steps with the resistance of near pairs on a device.

use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use crate::lists::DeviceList;
use crate::pair_rows::{NearInput, NearRows, PairSet, RowAddresses};
use crate::tables::NumberFormat;
use crate::task::{DeviceAddress, KernelTask};
use crate::vectors::SUM_THREADS;

/// Threads of a row, as in `gpu/kernels/near.h`.
const ROW_LANES: usize = 8;

/// A vector of six numbers of each particle, its residual, and that preconditioned.
#[derive(Debug, Clone, Copy)]
pub struct RowVectors {
    /// `x`
    pub unknowns: DeviceList,
    /// `r`
    pub residual: DeviceList,
    /// `z`
    pub preconditioned: DeviceList,
}

/// A step of an iteration: `x += length p` and `r -= length A p`.
#[derive(Debug, Clone, Copy)]
pub struct DeviceStep {
    /// Its length.
    pub length: f64,
    /// `p`
    pub direction: DeviceList,
    /// `A p`
    pub image: DeviceList,
}

/// Inner products of an iteration: `r z`, `r` times the `z` before a step, and the squares of an error and of the size
/// of the unknowns.
pub type ProductSums = [f64; 4];

impl KernelTask {
    /// The same with the vectors of a step, if there is one.
    pub(crate) fn with_step(self, step: Option<&DeviceStep>) -> Self {
        let Some(DeviceStep { length, direction, image }) = step else { return Self { direction: 0, ..self } };
        Self { x_factor: *length, direction: direction.address, image: image.address, ..self }
    }
}

impl SplitFarField {
    /// Copies the near field of a solve to the device.
    pub fn set_near(&mut self, input: &NearInput) -> Result<(), DeviceError> {
        let Self { device, buffers, near, task, tables, .. } = self;
        let (on, places) = (device.as_mut(), &mut buffers.near);
        near.stiff = RowAddresses::fill(&mut places.stiff, on, input.stiff, NumberFormat::Double)?;
        near.soft = RowAddresses::fill(&mut places.soft, on, input.soft, tables.numbers)?;
        task.row_inverses = places.inverses.fill(on, bytemuck::cast_slice(input.inverses))?;
        task.resistances = places.resistances.fill(on, bytemuck::cast_slice(input.resistances.as_flattened()))?;
        Ok(())
    }

    fn row_blocks(&self) -> usize {
        (ROW_LANES * self.task.particles as usize).div_ceil(SUM_THREADS)
    }

    /// Loads of near pairs in some motions, six numbers a particle; the sums of blocks of their products with the
    /// motions are left for [`Self::sum_up`]. With `single`, the loads of single spheres are added.
    fn launch_rows(
        &mut self,
        pairs: PairSet,
        single: bool,
        [motions, loads]: [&DeviceList; 2],
    ) -> Result<DeviceAddress, DeviceError> {
        let blocks = self.row_blocks();
        let list_sums = self.reserve_sums(1, blocks)?;
        let NearRows { stiff, soft } = self.near;
        let sets = [(PairSet::Stiff, stiff), (PairSet::Soft, soft)];
        let mut task = KernelTask { direction: motions.address, image: loads.address, list_sums, ..self.task };
        task.adds_single = i32::from(single);
        for (_, rows) in sets.into_iter().filter(|(set, _)| pairs == PairSet::All || pairs == *set) {
            let RowAddresses { starts, others, numbers, own, pairs, format } = rows;
            (task.row_starts, task.row_others, task.row_numbers, task.row_own) = (starts, others, numbers, own);
            task.row_entries = pairs;
            self.launch_vectors(&format!("row_loads_{}", format.suffix()), blocks, &task)?;
            (task.adds_rows, task.adds_single) = (1, 0);
        }
        Ok(list_sums)
    }

    /// Loads of near pairs in some motions, six numbers a particle each.
    pub fn pair_loads(&mut self, pairs: PairSet, lists: [&DeviceList; 2]) -> Result<(), DeviceError> {
        self.launch_rows(pairs, false, lists).map(drop)
    }

    /// Loads of near pairs and of single spheres in some motions, and their product with the motions.
    pub fn resisted(&mut self, pairs: PairSet, lists: [&DeviceList; 2]) -> Result<f64, DeviceError> {
        let list_sums = self.launch_rows(pairs, true, lists)?;
        let [product] = self.sum_up(list_sums, self.row_blocks())?;
        Ok(product)
    }

    /// Takes a step, if there is one, and preconditions the residual by blocks. The error is that of the motions of
    /// single spheres under the residual; sizes are those of motions, both weighted by the resistances.
    pub fn step_pairs(&mut self, at: &RowVectors, step: Option<&DeviceStep>) -> Result<ProductSums, DeviceError> {
        let blocks = self.blocks();
        let list_sums = self.reserve_sums(1, 4 * blocks)?;
        let (unknowns, residual) = (at.unknowns.address, at.residual.address);
        let preconditioned = at.preconditioned.address;
        let list_size = blocks as i64;
        let task = KernelTask { unknowns, residual, preconditioned, list_sums, list_size, ..self.task };
        self.launch_vectors("step_pairs", blocks, &task.with_step(step))?;
        self.sum_up(list_sums, blocks)
    }

    /// `to = loads - part`, minus the loads of single spheres in motions if there are any.
    pub fn remainder(
        &mut self,
        [loads, part]: [&DeviceList; 2],
        motions: Option<&DeviceList>,
        to: &DeviceList,
    ) -> Result<(), DeviceError> {
        let (residual, preconditioned, image) = (loads.address, part.address, to.address);
        let unknowns = motions.map_or(0, |list| list.address);
        let task = KernelTask { residual, preconditioned, image, unknowns, ..self.task };
        self.launch_vectors("remainder_pairs", to.count().div_ceil(SUM_THREADS), &task)
    }
}
