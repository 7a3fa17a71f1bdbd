//! Iteration for the stresslets of rigid spheres on a device, see `gpu/kernels/strain.h`.

use crate::device::DeviceError;
use crate::far_field::{Orders, SplitFarField};
use crate::lists::{DeviceList, MotionLists};
use crate::numbers::SolveSettings;
use crate::repeated::CommandList;
use crate::task::KernelTask;

/// Vectors of the iteration, five numbers of each particle, and motions that follow it.
#[derive(Debug, Clone, Copy)]
pub struct StrainVectors {
    /// `x`
    pub unknowns: DeviceList,
    /// `r`
    pub residual: DeviceList,
    /// `z`
    pub preconditioned: DeviceList,
    /// Resistances of single spheres to strain, by class of radius.
    pub resistances: DeviceList,
    /// Velocities, angular velocities and rates of strain of the unknowns, one list after the other.
    pub motion: DeviceList,
    /// Motions of the last direction.
    pub step: MotionLists,
}

/// Sums after a step: `r` times the `z` before it, `r z`, and the square of the size of the unknowns.
pub type StrainSums = [f64; 3];

impl SplitFarField {
    /// Preconditions the residual, and measures it.
    pub fn measure_strain(&mut self, at: &StrainVectors) -> Result<StrainSums, DeviceError> {
        self.set_state(&SolveSettings::default())?;
        let addresses = at.addresses();
        self.repeat(CommandList::MeasureStrain, &addresses, |field| field.launch_strain_step(at, None))?;
        self.strain_sums()
    }

    /// The next direction `p = z + turn p`, the step along it from a `product` of `r z`, and the new residual with its
    /// measures. With a turn of 0 the last direction may be undefined.
    pub fn iterate_strain(
        &mut self,
        at: &StrainVectors,
        direction: &DeviceList,
        [turn, product]: [f64; 2],
        orders: &Orders,
    ) -> Result<StrainSums, DeviceError> {
        self.set_state(&SolveSettings { turn, product, ..SolveSettings::default() })?;
        let [velocities, turns, strains] = at.step;
        (self.task.forces, self.task.torques, self.task.stresslets) = (0, 0, direction.address);
        (self.task.velocities, self.task.angular_velocities) = (velocities.address, turns.address);
        self.task.strain_rates = strains.address;
        let (orders, addresses) = (*orders, at.addresses().into_iter().chain([direction.address]).collect::<Vec<_>>());
        self.repeat(CommandList::IterateStrain, &addresses, |field| {
            let (next_direction, preconditioned) = (direction.address, at.preconditioned.address);
            let task = KernelTask { preconditioned, next_direction, ..field.task };
            field.launch_strain("turn", &task)?;
            field.evaluate_in_order(&orders)?;
            let (direction, list_sums) = (direction.address, field.sums(0));
            let task = KernelTask { list_sums, direction, ..field.task };
            field.launch_strain("product", &task)?;
            field.launch_strain_step(at, Some(direction))
        })?;
        self.strain_sums()
    }

    fn launch_strain(&mut self, kernel: &str, task: &KernelTask) -> Result<(), DeviceError> {
        self.launch_particles(&format!("strain_{kernel}_{}", self.tables.numbers.suffix()), task)
    }

    /// The step along a direction, if there is one, and the sums after it.
    fn launch_strain_step(&mut self, at: &StrainVectors, direction: Option<u64>) -> Result<(), DeviceError> {
        let (list_sums, blocks) = (self.sums(0), self.blocks());
        let task = KernelTask {
            list_weights: at.resistances.address,
            list_sums,
            block_sums: list_sums,
            unknowns: at.unknowns.address,
            residual: at.residual.address,
            preconditioned: at.preconditioned.address,
            direction: direction.unwrap_or(0),
            image: at.motion.address,
            list_size: blocks as i64,
            block_count: blocks as i64,
            ..self.task
        };
        self.launch_strain("step", &task)?;
        let after_product = list_sums + (size_of::<f64>() * blocks) as u64;
        self.launch_sums(after_product, blocks, size_of::<StrainSums>() / size_of::<f64>(), self.sums_of_state())
    }

    fn strain_sums(&mut self) -> Result<StrainSums, DeviceError> {
        if self.blocks() == 0 {
            return Ok(StrainSums::default());
        }
        let [former, product, size, ..] = self.state()?.sums;
        Ok([former, product, size])
    }
}

impl StrainVectors {
    fn addresses(&self) -> Vec<u64> {
        let Self { unknowns, residual, preconditioned, resistances, motion, step } = self;
        let lists = [unknowns, residual, preconditioned, resistances, motion].into_iter().chain(step);
        lists.map(|list| list.address).collect()
    }
}
