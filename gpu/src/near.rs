//! Products and steps with the resistance of near pairs on a device.

use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use crate::lists::DeviceList;
use crate::pair_rows::PairSet;
use crate::repeated::{PAIR_START, PAIR_STEPS};
use crate::task::{DeviceAddress, KernelTask};
use crate::vectors::SUM_THREADS;

/// Steps of an iteration for near pairs after which the host looks at its state; an even number.
const STEPS_AT_A_TIME: usize = 4;

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
    /// `p`, after steps of even and of odd numbers.
    pub directions: [DeviceList; 2],
    /// `A p`
    pub image: DeviceList,
}

/// An iteration that runs on the device: its state, pairs and vectors.
#[derive(Clone, Copy)]
struct PairIteration {
    state: DeviceAddress,
    pairs: PairSet,
    at: RowVectors,
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
}

impl SplitFarField {
    fn row_blocks(&self) -> usize {
        (ROW_LANES * self.task.particles as usize).div_ceil(SUM_THREADS)
    }

    /// Loads of near pairs in some motions, six numbers a particle each.
    pub fn pair_loads(&mut self, pairs: PairSet, lists: [&DeviceList; 2]) -> Result<(), DeviceError> {
        self.launch_rows(pairs, 0, lists)
    }

    /// Loads of near pairs and of single spheres in some motions.
    pub fn resisted(&mut self, pairs: PairSet, lists: [&DeviceList; 2]) -> Result<(), DeviceError> {
        self.launch_rows(pairs, 1, lists)
    }

    fn launch_rows(
        &mut self,
        pairs: PairSet,
        adds_single: i32,
        [motions, loads]: [&DeviceList; 2],
    ) -> Result<(), DeviceError> {
        let blocks = self.row_blocks();
        let list_sums = self.reserve_sums(1, blocks)?;
        let (direction, image) = (motions.address, loads.address);
        let task = KernelTask { direction, image, list_sums, pair_sets: pairs as i32, adds_single, ..self.task };
        self.launch_vectors(&format!("row_loads_{}", self.tables.numbers.suffix()), blocks, &task)
    }

    /// Solves for motions of spheres that interact by near pairs alone, from some motions with a known residual, by
    /// conjugate gradients that are preconditioned by groups. The error is that of the motions of single spheres under
    /// the residual, relative to the size of the motions, both weighted by the resistances. Steps run without the host,
    /// which looks from time to time whether the iteration has ended.
    pub fn solve_pairs(&mut self, pairs: PairSet, at: &RowVectors, limits: PairLimits) -> Result<(), DeviceError> {
        if self.blocks() == 0 {
            return Ok(());
        }
        let mut state = [0.0, 0.0, 1.0, 1.0, limits.tolerance * limits.tolerance, 0.0];
        let place = self.buffers.state.fill(self.device.as_mut(), bytemuck::cast_slice(&state))?;
        let iteration = PairIteration { state: place, pairs, at: *at };
        let [x, r, z, image] = [at.unknowns, at.residual, at.preconditioned, at.image].map(|list| list.address);
        let of_solve = [x, r, z, image, at.directions[0].address, at.directions[1].address, pairs as u64];
        self.repeat(PAIR_START, &of_solve, |field| {
            field.step_pairs(&iteration, None)?;
            field.turn_pairs(&iteration, 0)?;
            field.steps_of_pairs(&iteration)
        })?;
        loop {
            self.device.download(place, bytemuck::cast_slice_mut(&mut state))?;
            let [_, _, goes_on, _, _, steps] = state;
            if goes_on == 0.0 || steps >= limits.steps as f64 {
                return Ok(());
            }
            self.repeat(PAIR_STEPS, &of_solve, |field| field.steps_of_pairs(&iteration))?;
        }
    }

    /// Some steps of the iteration.
    fn steps_of_pairs(&mut self, iteration: &PairIteration) -> Result<(), DeviceError> {
        (0..STEPS_AT_A_TIME).try_for_each(|step| {
            self.step_pairs(iteration, Some(step % 2))?;
            self.turn_pairs(iteration, (step + 1) % 2)
        })
    }

    /// A step along the direction of a parity, if there is one, with the products from which the next one follows.
    fn step_pairs(&mut self, iteration: &PairIteration, parity: Option<usize>) -> Result<(), DeviceError> {
        let PairIteration { state, at, .. } = *iteration;
        let (blocks, of_rows) = (self.near.group_blocks, self.row_blocks());
        let (list_sums, block_sums) = (self.reserve_sums(1, 4 * blocks)?, self.reserve_sums(2, of_rows)?);
        let (unknowns, residual, image) = (at.unknowns.address, at.residual.address, at.image.address);
        let direction = parity.map_or(0, |parity| at.directions[parity].address);
        let (preconditioned, parity) = (at.preconditioned.address, parity.unwrap_or(0) as i32);
        let task = KernelTask { unknowns, residual, preconditioned, direction, image, state, parity, ..self.task };
        let (list_size, block_count) = (blocks as i64, of_rows as i64);
        let task = KernelTask { list_sums, block_sums, list_size, block_count, ..task };
        self.launch_vectors("step_pairs", blocks, &task)
    }

    /// The next direction, of a parity, and its image.
    fn turn_pairs(&mut self, iteration: &PairIteration, parity: usize) -> Result<(), DeviceError> {
        let &PairIteration { state, pairs, ref at } = iteration;
        let (blocks, of_groups) = (self.row_blocks(), self.near.group_blocks);
        let (list_sums, block_sums) = (self.reserve_sums(2, blocks)?, self.reserve_sums(1, 4 * of_groups)?);
        let (preconditioned, image) = (at.preconditioned.address, at.image.address);
        let (direction, next_direction) = (at.directions[1 - parity].address, at.directions[parity].address);
        let (pair_sets, adds_single, parity, block_count) = (pairs as i32, 1, parity as i32, of_groups as i64);
        let task = KernelTask { list_sums, preconditioned, direction, image, next_direction, ..self.task };
        let task = KernelTask { block_sums, state, block_count, pair_sets, adds_single, parity, ..task };
        self.launch_vectors(&format!("turn_pairs_{}", self.tables.numbers.suffix()), blocks, &task)
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
