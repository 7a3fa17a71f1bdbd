//! Products and steps with the resistance of near pairs on a device.

use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use crate::groups::group_blocks;
use crate::lists::DeviceList;
use crate::numbers::{SolveSettings, SolveState};
use crate::pair_rows::{PairSet, ROW_LANES};
use crate::repeated::CommandList;
use crate::task::{DeviceAddress, KernelTask};
use crate::vectors::SUM_THREADS;

/// Steps of an iteration for near pairs after which the host looks at its state, and the most to which the first ones
/// grow if solves take more; even numbers.
const STEPS_AT_A_TIME: usize = 4;
const MOST_AT_A_TIME: usize = 12;

/// Vectors of a solve for near pairs besides its unknowns, six numbers of each particle.
#[derive(Debug, Clone, Copy)]
pub struct PairVectors {
    /// Given loads.
    pub given: DeviceList,
    /// `r`
    pub residual: DeviceList,
    /// `z`
    pub preconditioned: DeviceList,
    /// `p`, after steps of even and of odd numbers.
    pub directions: [DeviceList; 2],
    /// `A p`
    pub image: DeviceList,
}

/// A solve for motions of spheres that interact by near pairs alone.
#[derive(Debug, Clone, Copy)]
pub struct PairSolve {
    /// The pairs.
    pub pairs: PairSet,
    /// Motions, and the loads of the pairs in them.
    pub motions: DeviceList,
    /// See [`Self::motions`].
    pub loads: DeviceList,
    /// Other vectors.
    pub vectors: PairVectors,
}

/// Limits of an iteration for near pairs.
#[derive(Debug, Clone, Copy)]
pub struct PairLimits {
    /// Relative error.
    pub tolerance: f64,
    /// Number of steps, up to a few more.
    pub steps: usize,
}

impl PairSolve {
    /// Addresses of all vectors, and the set of pairs.
    fn key(&self) -> impl Iterator<Item = u64> {
        let PairVectors { given, residual, preconditioned, directions: [even, odd], image } = self.vectors;
        let lists = [self.motions, self.loads, given, residual, preconditioned, even, odd, image];
        lists.into_iter().map(|list| list.address).chain([self.pairs as u64])
    }
}

/// Commands of [`SplitFarField::solve_within`] around an iteration for near pairs, which depend on addresses.
pub(crate) struct Around<B, A> {
    /// Commands before the iteration, and after its steps.
    pub before: B,
    pub after: A,
    /// Recordings of all, and of further steps with what comes after them.
    pub recordings: [CommandList; 2],
    pub addresses: Vec<DeviceAddress>,
}

impl SplitFarField {
    fn row_blocks(&self) -> usize {
        (ROW_LANES * self.task.particles as usize).div_ceil(SUM_THREADS)
    }

    /// Loads of near pairs in some motions, six numbers a particle each; with those of single spheres if they are asked
    /// for.
    pub(crate) fn launch_rows(
        &mut self,
        pairs: PairSet,
        adds_single: bool,
        [motions, loads]: [&DeviceList; 2],
    ) -> Result<(), DeviceError> {
        let (direction, image, list_sums) = (motions.address, loads.address, self.sums(1));
        let (pair_sets, adds_single) = (pairs as i32, i32::from(adds_single));
        let task = KernelTask { list_sums, direction, image, pair_sets, adds_single, ..self.task };
        self.launch_vectors(&format!("row_loads_{}", self.tables.numbers.suffix()), self.row_blocks(), &task)
    }

    /// Solves from the motions that are there, by conjugate gradients that are preconditioned by groups. The error is
    /// that of the motions of single spheres under the residual, relative to the size of the motions, both weighted by
    /// the resistances. Steps run without the host, which looks from time to time whether the iteration has ended.
    pub fn solve_pairs(&mut self, solve: &PairSolve, limits: PairLimits) -> Result<(), DeviceError> {
        let &PairSolve { pairs, motions, loads, vectors: PairVectors { given, residual, image, .. } } = solve;
        let around = Around {
            before: |field: &mut Self| {
                field.launch_rows(pairs, true, [&motions, &image])?;
                field.remainder([&given, &image], None, &residual)
            },
            after: |field: &mut Self| field.remainder([&given, &residual], Some(&motions), &loads),
            recordings: [CommandList::AllPairs, CommandList::MoreOfAllPairs],
            addresses: Vec::new(),
        };
        self.solve_within(solve, &around, SolveSettings::new(limits.tolerance), limits).map(drop)
    }

    /// Continues an earlier solve whose loads are there.
    pub fn continue_pairs(&mut self, solve: &PairSolve, limits: PairLimits) -> Result<(), DeviceError> {
        let &PairSolve { motions, loads, vectors: PairVectors { given, residual, .. }, .. } = solve;
        let around = Around {
            before: |field: &mut Self| field.remainder([&given, &loads], Some(&motions), &residual),
            after: |field: &mut Self| field.remainder([&given, &residual], Some(&motions), &loads),
            recordings: [CommandList::LastPairs, CommandList::MoreOfLastPairs],
            addresses: Vec::new(),
        };
        self.solve_within(solve, &around, SolveSettings::new(limits.tolerance), limits).map(drop)
    }

    /// Runs commands after which motions have a residual, solves from there, and runs commands that follow. Returns the
    /// state after these.
    pub(crate) fn solve_within(
        &mut self,
        solve: &PairSolve,
        around: &Around<impl Fn(&mut Self) -> Result<(), DeviceError>, impl Fn(&mut Self) -> Result<(), DeviceError>>,
        settings: SolveSettings,
        limits: PairLimits,
    ) -> Result<SolveState, DeviceError> {
        if self.blocks() == 0 {
            return Ok(SolveState::default());
        }
        let addresses: Vec<_> = solve.key().chain(around.addresses.iter().copied()).collect();
        let ([first, more], place) = (around.recordings, around.recordings[0] as usize);
        let steps_at_first = STEPS_AT_A_TIME + self.near.more_steps[place];
        let of_first: Vec<_> = addresses.iter().copied().chain([steps_at_first as u64]).collect();
        self.set_state(&settings)?;
        self.repeat(first, &of_first, |field| {
            (around.before)(field)?;
            field.step_pairs(solve, None)?;
            field.turn_pairs(solve, 0)?;
            field.steps_of_pairs(solve, steps_at_first)?;
            (around.after)(field)
        })?;
        loop {
            let state = self.state()?;
            let SolveSettings { goes_on: [goes_on, _], steps, .. } = state.settings;
            if goes_on == 0.0 || steps >= limits.steps as f64 {
                let needed = (steps as usize).next_multiple_of(2).clamp(steps_at_first, MOST_AT_A_TIME);
                self.near.more_steps[place] = needed - STEPS_AT_A_TIME;
                return Ok(state);
            }
            self.repeat(more, &addresses, |field| {
                field.steps_of_pairs(solve, STEPS_AT_A_TIME)?;
                (around.after)(field)
            })?;
        }
    }

    /// Some steps of the iteration.
    fn steps_of_pairs(&mut self, solve: &PairSolve, steps: usize) -> Result<(), DeviceError> {
        (0..steps).try_for_each(|step| {
            self.step_pairs(solve, Some(step % 2))?;
            self.turn_pairs(solve, (step + 1) % 2)
        })
    }

    /// A step along the direction of a parity, if there is one, with the products from which the next one follows.
    fn step_pairs(&mut self, solve: &PairSolve, parity: Option<usize>) -> Result<(), DeviceError> {
        let PairVectors { residual, preconditioned, directions, image, .. } = solve.vectors;
        let (blocks, of_rows) = (group_blocks(self.task.particles as usize), self.row_blocks());
        let (list_sums, block_sums) = (self.sums(1), self.sums(2));
        let [unknowns, residual, image] = [solve.motions, residual, image].map(|list| list.address);
        let direction = parity.map_or(0, |parity| directions[parity].address);
        let (preconditioned, parity) = (preconditioned.address, parity.unwrap_or(0) as i32);
        let task = KernelTask { unknowns, residual, preconditioned, direction, image, parity, ..self.task };
        let (list_size, block_count) = (blocks as i64, of_rows as i64);
        let task = KernelTask { list_sums, block_sums, list_size, block_count, ..task };
        self.launch_vectors("step_pairs", blocks, &task)
    }

    /// The next direction, of a parity, and its image.
    fn turn_pairs(&mut self, solve: &PairSolve, parity: usize) -> Result<(), DeviceError> {
        let PairVectors { preconditioned, directions, image, .. } = solve.vectors;
        let (block_count, list_sums, block_sums) =
            (group_blocks(self.task.particles as usize) as i64, self.sums(2), self.sums(1));
        let (preconditioned, image) = (preconditioned.address, image.address);
        let (direction, next_direction) = (directions[1 - parity].address, directions[parity].address);
        let (pair_sets, adds_single, parity) = (solve.pairs as i32, 1, parity as i32);
        let task = KernelTask { list_sums, preconditioned, direction, image, next_direction, ..self.task };
        let task = KernelTask { block_sums, block_count, pair_sets, adds_single, parity, ..task };
        self.launch_vectors(&format!("turn_pairs_{}", self.tables.numbers.suffix()), self.row_blocks(), &task)
    }

    /// `to = loads - part`, minus the loads of single spheres in motions if there are any.
    pub(crate) fn remainder(
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
