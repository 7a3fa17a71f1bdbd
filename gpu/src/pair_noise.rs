//! Random forces and torques of lubrication on a device, see `gpu/kernels/pair_noise.h`.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::{PARTICLE_THREADS, SplitFarField};
use crate::lists::DeviceList;
use crate::numbers::KernelNumbers;
use crate::tables::periods_of;
use crate::task::{DeviceAddress, KernelTask};

/// Input of a draw of random loads of near pairs.
#[derive(Debug, Clone, Copy)]
pub struct PairDraw<'a> {
    /// Ids of the particles.
    pub ids: &'a [u64],
    /// Places of the particles, unless they have moved on the device.
    pub places: Option<PeriodicPlaces<'a>>,
    /// Seed of the numbers.
    pub seed: u64,
    /// Factor of the loads.
    pub factor: f64,
    /// Loads to which these are added, six numbers a particle, if there are any.
    pub given: Option<DeviceList>,
}

/// Places of particles in a periodic box.
#[derive(Debug, Clone, Copy)]
pub struct PeriodicPlaces<'a> {
    /// Lattice coordinates as fractions of the edges, three each, by which the particles were arranged.
    pub fractions: &'a [f64],
    /// Steps that particles have made across the faces of the box.
    pub steps: &'a [[i32; 3]],
}

impl SplitFarField {
    /// Random forces and torques of all near pairs on the arranged particles, six numbers each, whose covariance is the
    /// resistance of lubrication times the square of the factor.
    ///
    /// # Panics
    /// Without [`Self::set_near_tables`].
    pub fn random_pair_loads(&mut self, draw: &PairDraw) -> Result<DeviceList, DeviceError> {
        let reach = self.near.reach.expect("the tables of near pairs are on the device");
        let (blocks, threads) = (self.particle_blocks(1, PARTICLE_THREADS), PARTICLE_THREADS);
        self.set_numbers(&KernelNumbers { noise_seed: draw.seed, ..self.numbers })?;
        let loads = self.wide_list(SIX * self.task.particles as usize)?;
        if blocks == 0 {
            return Ok(loads);
        }
        let (ids, periods) = (self.place_ids(draw.ids)?, self.place_periods(draw)?);
        let (image, near_reach, factor) = (loads.address, self.bins_within(reach), draw.factor);
        let ambient = draw.given.map_or(0, |list| list.address);
        let task = KernelTask { ids, periods, image, ambient, factor, near_reach, ..self.task };
        let kernel = &format!("random_loads_{}", self.tables.numbers.suffix());
        self.device.launch(&KernelLaunch { kernel, blocks, threads }, &task)?;
        Ok(loads)
    }

    /// Whether there are tables of near pairs that are lubricated.
    pub fn has_lubrication(&self) -> bool {
        self.task.near_series != 0
    }

    /// Place of the steps of the particles across the faces of the box. Positions on the device leave out whole periods
    /// of these.
    fn place_periods(&mut self, draw: &PairDraw) -> Result<DeviceAddress, DeviceError> {
        let of_periods = &mut self.buffers.names[1];
        let Some(PeriodicPlaces { fractions, steps }) = draw.places else { return Ok(of_periods.address()) };
        let left_out = periods_of(fractions);
        let periods: Vec<i32> = steps.as_flattened().iter().zip(left_out).map(|(step, out)| step - out).collect();
        of_periods.fill(self.device.as_mut(), bytemuck::cast_slice(&periods))
    }
}

/// Numbers of a load.
const SIX: usize = 6;
