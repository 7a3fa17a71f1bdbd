//! Random forces and torques of lubrication on a device, see `gpu/kernels/pair_noise.h`.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::{PARTICLE_THREADS, SplitFarField};
use crate::numbers::KernelNumbers;
use crate::tables::{NumberFormat, periods_of};
use crate::task::KernelTask;

/// Input of a draw of random loads of near pairs.
#[derive(Debug, Clone, Copy)]
pub struct PairDraw<'a> {
    /// Ids of the particles.
    pub ids: &'a [u64],
    /// Lattice coordinates as fractions of the edges, three each, by which the particles were arranged.
    pub fractions: &'a [f64],
    /// Steps that particles have made across the faces of the box.
    pub steps: &'a [[i32; 3]],
    /// Seed of the numbers.
    pub seed: u64,
}

impl SplitFarField {
    /// Random forces and torques of all near pairs on the arranged particles, six numbers each, whose covariance is the
    /// resistance of lubrication.
    ///
    /// # Panics
    /// Without [`Self::set_near_tables`].
    pub fn random_pair_loads(&mut self, draw: &PairDraw) -> Result<Vec<f64>, DeviceError> {
        let reach = self.near.reach.expect("the tables of near pairs are on the device");
        let (blocks, threads) = (self.particle_blocks(1, PARTICLE_THREADS), PARTICLE_THREADS);
        if blocks == 0 || self.task.near_kinds == 0 {
            return Ok(vec![0.0; SIX * self.task.particles as usize]);
        }
        self.set_numbers(&KernelNumbers { noise_seed: draw.seed, ..self.numbers })?;
        let loads = self.wide_list(SIX * self.task.particles as usize)?;
        // Positions on the device leave out whole periods of the lattice.
        let left_out = periods_of(draw.fractions);
        let periods: Vec<i32> = draw.steps.as_flattened().iter().zip(left_out).map(|(step, out)| step - out).collect();
        let (on, [of_ids, of_periods]) = (self.device.as_mut(), &mut self.buffers.names);
        let ids = of_ids.fill(on, bytemuck::cast_slice(draw.ids))?;
        let periods = of_periods.fill(on, bytemuck::cast_slice(&periods))?;
        let (image, near_reach) = (loads.address, self.bins_within(reach));
        let task = KernelTask { ids, periods, image, near_reach, ..self.task };
        let kernel = &format!("random_loads_{}", self.tables.numbers.suffix());
        self.device.launch(&KernelLaunch { kernel, blocks, threads }, &task)?;
        let values = self.download(loads.address, loads.count, NumberFormat::Double)?;
        self.release(&loads);
        Ok(values)
    }
}

/// Numbers of a load.
const SIX: usize = 6;
