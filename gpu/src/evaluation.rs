//! Order of an evaluation: kernels of the split method on a device.

use crate::device::{DeviceError, TransformPart, TransformTask};
use crate::far_field::{DeviceLoads, DeviceMotion, Orders, PARTICLE_THREADS, SplitFarField, StageSeconds};
use crate::numbers::KernelNumbers;
use crate::tables::{GridSolve, NumberFormat};
use crate::task::KernelTask;
use std::time::Instant;

/// Threads of blocks and of a particle, as in `gpu/kernels`.
const TILE_THREADS: usize = 64;
const PAIR_LANES: usize = 8;
pub(crate) const MODE_THREADS: usize = 256;
const CHANNEL_COLUMNS: usize = 32;
const CHANNEL_SLICES: usize = 4;
const MEAN_THREADS: usize = 128;

/// Parts of an evaluation, in their order.
#[derive(Clone, Copy)]
enum EvaluationStage {
    Spread,
    Transform,
    Interpolate,
    Near,
}

impl EvaluationStage {
    const ALL: [Self; 4] = [Self::Spread, Self::Transform, Self::Interpolate, Self::Near];

    fn of(self, seconds: &mut StageSeconds) -> &mut f64 {
        match self {
            Self::Spread => &mut seconds.spread,
            Self::Transform => &mut seconds.transform,
            Self::Interpolate => &mut seconds.interpolate,
            Self::Near => &mut seconds.near,
        }
    }
}

impl SplitFarField {
    /// Runs the kernels of an evaluation on the loads and motions of the task, and measures the time of each stage.
    pub(crate) fn evaluate(&mut self, orders: &Orders) -> Result<(), DeviceError> {
        self.reserve_records()?;
        for stage in EvaluationStage::ALL {
            let clock = Instant::now();
            self.run(stage, orders)?;
            self.device.finish()?;
            *stage.of(&mut self.seconds) += clock.elapsed().as_secs_f64();
        }
        Ok(())
    }

    /// The same without waiting for any of them.
    pub(crate) fn evaluate_in_order(&mut self, orders: &Orders) -> Result<(), DeviceError> {
        self.reserve_records()?;
        EvaluationStage::ALL.into_iter().try_for_each(|stage| self.run(stage, orders))
    }

    pub(crate) fn reserve_records(&mut self) -> Result<(), DeviceError> {
        let bytes = 12 * self.task.particles as usize * self.tables.numbers.size();
        self.task.records = self.buffers.records.reserve(self.device.as_mut(), bytes)?;
        Ok(())
    }

    fn run(&mut self, stage: EvaluationStage, orders: &Orders) -> Result<(), DeviceError> {
        let suffix = self.tables.numbers.suffix();
        match stage {
            EvaluationStage::Spread => {
                self.run_over_particles("gather_loads", PARTICLE_THREADS)?;
                let tiles = self.task.tiles.iter().map(|&n| n as usize).product();
                self.launch(&format!("spread_{}_{suffix}", orders.spread), tiles, TILE_THREADS)
            }
            EvaluationStage::Transform => self.solve(),
            EvaluationStage::Interpolate => {
                let blocks = self.particle_blocks(self.task.lanes as usize, PARTICLE_THREADS);
                self.launch(&format!("interpolate_{}_{suffix}", orders.interpolate), blocks, PARTICLE_THREADS)?;
                self.collect_sums()
            }
            EvaluationStage::Near => {
                let blocks = self.particle_blocks(PAIR_LANES, PARTICLE_THREADS);
                self.launch(&format!("pair_motions_{suffix}"), blocks, PARTICLE_THREADS)?;
                self.add_images()
            }
        }
    }

    /// Velocities on the grid of the loads there.
    fn solve(&mut self) -> Result<(), DeviceError> {
        let kernel = if matches!(self.tables.solve, GridSolve::Unbounded(_)) { "solve_open" } else { "solve" };
        let is_channel = matches!(self.tables.solve, GridSolve::Channel(_));
        if self.tables.share.is_whole() && !is_channel {
            return self.solve_between(kernel, TransformPart::Whole);
        }
        self.columns_from_grid()?;
        if !is_channel {
            self.solve_between(kernel, TransformPart::AlongZ)?;
            return self.grid_from_columns();
        }
        let (blocks, threads) = (self.tables.columns().div_ceil(CHANNEL_COLUMNS), CHANNEL_COLUMNS * CHANNEL_SLICES);
        let suffix = self.tables.numbers.suffix();
        let has_mean = self.tables.share.own_modes().contains(&0);
        self.launch(&format!("channel_mean_{suffix}"), usize::from(has_mean), MEAN_THREADS)?;
        self.launch(&format!("channel_moments_{suffix}"), blocks, threads)?;
        self.solve_between(kernel, TransformPart::AlongZ)?;
        self.launch(&format!("channel_flow_{suffix}"), blocks, threads)?;
        self.grid_from_columns()
    }

    /// Multiplies modes by a Green's function between transforms.
    fn solve_between(&mut self, kernel: &str, part: TransformPart) -> Result<(), DeviceError> {
        self.transform(true, part)?;
        let name = format!("{kernel}_{}", self.tables.numbers.suffix());
        self.launch(&name, self.tables.modes().div_ceil(MODE_THREADS), MODE_THREADS)?;
        self.transform(false, part)
    }

    /// Values on the grid from its modes.
    fn grid_from_modes(&mut self) -> Result<(), DeviceError> {
        if self.tables.share.is_whole() {
            return self.transform(false, TransformPart::Whole);
        }
        self.transform(false, TransformPart::AlongZ)?;
        self.grid_from_columns()
    }

    pub(crate) fn transform(&mut self, is_forward: bool, part: TransformPart) -> Result<(), DeviceError> {
        let is_single = self.tables.numbers == NumberFormat::Single;
        let (KernelTask { field, spectrum, .. }, [x, y, z]) = (self.task, self.tables.grid);
        let points = match part {
            TransformPart::Whole => [x, y, z],
            TransformPart::Planes => [x, y, self.tables.share.own_planes().len()],
            TransformPart::AlongZ => [x, self.tables.share.own_modes().len(), z],
        };
        if points.contains(&0) {
            return Ok(());
        }
        self.device.transform(&TransformTask { is_forward, is_single, part, points, field, spectrum })
    }
}

/// Parts of an evaluation by themselves.
impl SplitFarField {
    /// Random motions whose covariance is the part on the grid, by a seed: velocities, and gradients if they are asked
    /// for. They are on the device, see [`Self::copy_motion`].
    pub fn random_field(&mut self, seed: u64, orders: &Orders) -> Result<(), DeviceError> {
        self.copy_loads(&DeviceLoads::default(), orders)?;
        self.reserve_records()?;
        self.run_over_particles("gather_loads", PARTICLE_THREADS)?;
        let suffix = self.tables.numbers.suffix();
        self.set_numbers(&KernelNumbers { noise_seed: seed, ..self.numbers })?;
        self.launch(&format!("random_modes_{suffix}"), self.tables.modes().div_ceil(MODE_THREADS), MODE_THREADS)?;
        self.grid_from_modes()?;
        self.run(EvaluationStage::Interpolate, orders)?;
        self.run(EvaluationStage::Near, orders)
    }

    /// Motions that loads cause besides the part on the grid.
    pub fn pair_corrections(&mut self, loads: &DeviceLoads, orders: &Orders) -> Result<DeviceMotion, DeviceError> {
        self.copy_loads(loads, orders)?;
        self.clear_grid()?;
        self.correct_pairs(orders)?;
        self.copy_motion()
    }

    /// Leaves motions on the grid at zero.
    pub(crate) fn clear_grid(&mut self) -> Result<(), DeviceError> {
        let bytes = 12 * self.task.particles as usize * self.tables.numbers.size();
        self.device.zero(self.task.interpolated, bytes)
    }

    /// Adds motions by the pair corrections of the loads to those on the grid.
    pub(crate) fn correct_pairs(&mut self, orders: &Orders) -> Result<(), DeviceError> {
        self.reserve_records()?;
        self.run_over_particles("gather_loads", PARTICLE_THREADS)?;
        self.run(EvaluationStage::Near, orders)
    }
}
