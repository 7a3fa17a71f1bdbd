//! Vectors of an iteration in the memory of a device.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::{Orders, SplitFarField};
use crate::task::{DeviceAddress, KernelTask};

/// Threads of a block, as in `gpu/kernels/vectors.h`.
const SUM_THREADS: usize = 256;

/// Values in the memory of a device.
#[derive(Debug)]
pub struct DeviceList {
    address: DeviceAddress,
    count: usize,
}

/// Lists of velocities, angular velocities and rates of strain.
pub type MotionLists = [DeviceList; 3];

impl SplitFarField {
    /// A list of this many values, which are undefined.
    pub fn list(&mut self, count: usize) -> Result<DeviceList, DeviceError> {
        let address = self.device.allocate(count * self.tables.numbers.size())?;
        Ok(DeviceList { address, count })
    }

    /// A list of these values.
    pub fn list_of(&mut self, values: &[f64]) -> Result<DeviceList, DeviceError> {
        let list = self.list(values.len())?;
        let bytes = self.tables.numbers.bytes_of(values.iter().copied());
        self.device.upload(list.address, &bytes)?;
        Ok(list)
    }

    /// The values of a list.
    pub fn values_of(&mut self, list: &DeviceList) -> Result<Vec<f64>, DeviceError> {
        self.download(list.address, list.count)
    }

    /// Lists for the motions of all particles.
    pub fn motion_lists(&mut self) -> Result<MotionLists, DeviceError> {
        let count = self.task.particles as usize;
        Ok([self.list(3 * count)?, self.list(3 * count)?, self.list(5 * count)?])
    }

    /// Releases the memory of a list.
    pub fn release(&mut self, list: &DeviceList) {
        self.device.release(list.address);
    }

    /// `y = x_factor x + y_factor y`, where a `y` that is not used may be undefined.
    pub fn combine(&mut self, factors: [f64; 2], x: &DeviceList, y: &DeviceList) -> Result<(), DeviceError> {
        let [x_factor, y_factor] = factors;
        let (list_x, list_y, list_size) = (x.address, y.address, y.count as i64);
        let task = KernelTask { list_x, list_y, x_factor, y_factor, list_size, ..self.task };
        self.launch_on("combine", y.count.div_ceil(SUM_THREADS), &task)
    }

    /// `y = x` times the weight of each particle's class.
    pub fn weigh(&mut self, weights: &DeviceList, x: &DeviceList, y: &DeviceList) -> Result<(), DeviceError> {
        let (list_x, list_y, list_weights) = (x.address, y.address, weights.address);
        let task = KernelTask { list_x, list_y, list_weights, ..self.task };
        self.launch_on("weigh", self.blocks(), &task)
    }

    /// Sum of the products of the matrices of each particle, over the weights of their classes if there are any.
    pub fn contract(
        &mut self,
        x: &DeviceList,
        y: &DeviceList,
        weights: Option<&DeviceList>,
    ) -> Result<f64, DeviceError> {
        let blocks = self.blocks();
        if blocks == 0 {
            return Ok(0.0);
        }
        let list_sums = self.buffers.sums.reserve(self.device.as_mut(), size_of::<f64>() * blocks)?;
        let list_weights = weights.map_or(0, |list| list.address);
        let task = KernelTask { list_x: x.address, list_y: y.address, list_weights, list_sums, ..self.task };
        self.launch_on("sum_products", blocks, &task)?;
        let task = KernelTask { list_size: blocks as i64, ..task };
        self.device.launch(&KernelLaunch { kernel: "sum_up", blocks: 1, threads: SUM_THREADS }, &task)?;
        let mut sum = [0.0_f64];
        self.device.download(list_sums, bytemuck::cast_slice_mut(&mut sum))?;
        Ok(sum[0])
    }

    /// Motions that stresslets cause, without a copy to the host.
    pub fn apply_stresslets(
        &mut self,
        stresslets: &DeviceList,
        motion: &MotionLists,
        orders: &Orders,
    ) -> Result<(), DeviceError> {
        (self.task.forces, self.task.torques, self.task.stresslets) = (0, 0, stresslets.address);
        let [velocities, turns, strains] = motion;
        (self.task.velocities, self.task.angular_velocities) = (velocities.address, turns.address);
        self.task.strain_rates = strains.address;
        self.evaluate(orders)
    }

    fn blocks(&self) -> usize {
        (self.task.particles as usize).div_ceil(SUM_THREADS)
    }

    /// Runs a kernel of this precision, unless there is nothing to do.
    fn launch_on(&mut self, kernel: &str, blocks: usize, task: &KernelTask) -> Result<(), DeviceError> {
        if blocks == 0 {
            return Ok(());
        }
        let kernel = &format!("{kernel}_{}", self.tables.numbers.suffix());
        self.device.launch(&KernelLaunch { kernel, blocks, threads: SUM_THREADS }, task)
    }
}
