//! Products and steps with the resistance of near pairs on a device.

use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use crate::lists::DeviceList;
use crate::pair_rows::{NearRows, PairSet, RowAddresses};
use crate::repeated::PAIR_STEPS;
use crate::task::{DeviceAddress, KernelTask};
use crate::vectors::SUM_THREADS;

/// Steps of an iteration for near pairs after which the host looks at its state.
const STEPS_AT_A_TIME: usize = 6;

/// Threads of a row, as in `gpu/kernels/near.h`.
const ROW_LANES: usize = 8;

/// Vectors of an iteration, six numbers of each particle.
#[derive(Debug, Clone, Copy)]
pub struct RowVectors {
    /// `x`
    pub unknowns: DeviceList,
    /// `r`
    pub residual: DeviceList,
    /// `z`
    pub preconditioned: DeviceList,
    /// `p`
    pub direction: DeviceList,
    /// `A p`
    pub image: DeviceList,
}

/// Limits of an iteration for near pairs.
#[derive(Debug, Clone, Copy)]
pub struct PairLimits {
    /// Relative error.
    pub tolerance: f64,
    /// Number of steps, up to a few more.
    pub steps: usize,
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

    /// The same with the rows of a set of pairs.
    pub(crate) fn with_rows(self, rows: &RowAddresses) -> Self {
        let &RowAddresses { starts, others, numbers, own, pairs, .. } = rows;
        let of_pairs = Self { row_starts: starts, row_others: others, row_numbers: numbers, ..self };
        Self { row_own: own, row_entries: pairs, ..of_pairs }
    }
}

impl SplitFarField {
    fn row_blocks(&self) -> usize {
        (ROW_LANES * self.task.particles as usize).div_ceil(SUM_THREADS)
    }

    /// Loads of near pairs in some motions, six numbers a particle; the sums of blocks of their products with the
    /// motions are left at the address that is returned. With `single`, the loads of single spheres are added. In an
    /// iteration that has ended, by its state, nothing changes.
    fn launch_rows(
        &mut self,
        pairs: PairSet,
        single: bool,
        [motions, loads]: [&DeviceList; 2],
        state: DeviceAddress,
    ) -> Result<DeviceAddress, DeviceError> {
        let blocks = self.row_blocks();
        let list_sums = self.reserve_sums(1, blocks)?;
        let NearRows { stiff, soft, .. } = self.near;
        let sets = [(PairSet::Stiff, stiff), (PairSet::Soft, soft)];
        let mut task = KernelTask { direction: motions.address, image: loads.address, list_sums, state, ..self.task };
        task.adds_single = i32::from(single);
        for (_, rows) in sets.into_iter().filter(|(set, _)| pairs == PairSet::All || pairs == *set) {
            task = task.with_rows(&rows);
            self.launch_vectors(&format!("row_loads_{}", rows.format.suffix()), blocks, &task)?;
            (task.adds_rows, task.adds_single) = (1, 0);
        }
        Ok(list_sums)
    }

    /// Loads of near pairs in some motions, six numbers a particle each.
    pub fn pair_loads(&mut self, pairs: PairSet, lists: [&DeviceList; 2]) -> Result<(), DeviceError> {
        self.launch_rows(pairs, false, lists, 0).map(drop)
    }

    /// Loads of near pairs and of single spheres in some motions.
    pub fn resisted(&mut self, pairs: PairSet, lists: [&DeviceList; 2]) -> Result<(), DeviceError> {
        self.launch_rows(pairs, true, lists, 0).map(drop)
    }

    /// Solves for motions of spheres that interact by near pairs alone, from some motions with a known residual, by
    /// conjugate gradients that are preconditioned by blocks. The error is that of the motions of single spheres under
    /// the residual, relative to the size of the motions, both weighted by the resistances. Steps run without the host,
    /// which looks from time to time whether the iteration has ended.
    pub fn solve_pairs(&mut self, pairs: PairSet, at: &RowVectors, limits: PairLimits) -> Result<(), DeviceError> {
        if self.blocks() == 0 {
            return Ok(());
        }
        let mut state = [0.0, 0.0, 0.0, limits.tolerance * limits.tolerance, 0.0, 1.0];
        let place = self.buffers.state.fill(self.device.as_mut(), bytemuck::cast_slice(&state))?;
        self.finish_step(place, at, 0)?;
        let addresses = [at.unknowns, at.residual, at.preconditioned, at.direction, at.image].map(|list| list.address);
        let of_solve = [&addresses[..], &[pairs as u64]].concat();
        loop {
            self.device.download(place, bytemuck::cast_slice_mut(&mut state))?;
            let [.., steps, is_active] = state;
            if is_active == 0.0 || steps >= limits.steps as f64 {
                return Ok(());
            }
            let at = *at;
            self.repeat(PAIR_STEPS, &of_solve, |field| {
                (0..STEPS_AT_A_TIME).try_for_each(|_| field.step_pairs(place, pairs, &at))
            })?;
        }
    }

    /// A step of the iteration.
    fn step_pairs(&mut self, state: DeviceAddress, pairs: PairSet, at: &RowVectors) -> Result<(), DeviceError> {
        let list_sums = self.launch_rows(pairs, true, [&at.direction, &at.image], state)?;
        let (list_size, totals) = (self.row_blocks() as i64, self.place_of_totals()?);
        let task = KernelTask { list_sums, totals, state, list_size, ..self.task };
        self.launch_vectors("length_pairs", 1, &task)?;
        self.finish_step(state, at, at.direction.address)
    }

    /// A step along a direction whose length is known, if there is one, and the next direction.
    fn finish_step(&mut self, state: DeviceAddress, at: &RowVectors, direction: u64) -> Result<(), DeviceError> {
        let blocks = self.blocks();
        let (list_sums, totals) = (self.reserve_sums(1, 4 * blocks)?, self.place_of_totals()?);
        let (unknowns, residual, image) = (at.unknowns.address, at.residual.address, at.image.address);
        let (preconditioned, list_size) = (at.preconditioned.address, blocks as i64);
        let task = KernelTask { unknowns, residual, preconditioned, direction, image, ..self.task };
        let task = KernelTask { list_sums, totals, state, list_size, ..task };
        self.launch_vectors("step_pairs", blocks, &task)?;
        self.launch_vectors("turn_pairs", 1, &task)?;
        let task = KernelTask { image: at.direction.address, ..task };
        self.launch_vectors("next_pairs", at.direction.count().div_ceil(SUM_THREADS), &task)
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
        let task = KernelTask { unknowns, residual, preconditioned, image, ..self.task };
        self.launch_vectors("remainder_pairs", to.count().div_ceil(SUM_THREADS), &task)
    }
}
