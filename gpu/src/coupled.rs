//! Vectors of the coupled solve of near pairs and far field on a device, see `gpu/kernels/coupled.h`.

use crate::device::DeviceError;
use crate::far_field::{Orders, SplitFarField};
use crate::lists::DeviceList;
use crate::near::{DeviceStep, ProductSums};
use crate::pair_rows::PairSet;
use crate::repeated::EVALUATION;
use crate::task::KernelTask;

/// Numbers of a particle in the unknowns: minus its motion in the loads of stiff pairs, these loads, the same of soft
/// pairs, six numbers each, and minus its stresslet.
pub const UNKNOWNS: usize = 4 * 6 + 5;

/// Numbers of a particle in a residual: motions for stiff and for soft pairs, and the rate of strain.
pub const RESIDUALS: usize = 2 * 6 + 5;

/// Numbers of a particle in the result without the first moment: motion, load on the far field, minus the stresslet,
/// and rate of strain.
pub const RESULTS: usize = 2 * 6 + 2 * 5;

/// Factors from the units of the solve to those of the far field.
#[derive(Debug, Clone, Copy)]
pub struct LoadFactors {
    /// Of forces.
    pub force: f64,
    /// Of torques and stresslets.
    pub torque: f64,
    /// From velocities of the far field to those of the solve.
    pub velocity: f64,
    /// The same of angular velocities and rates of strain.
    pub rate: f64,
}

/// Vectors of the solve.
#[derive(Debug, Clone, Copy)]
pub struct CoupledVectors {
    /// `x`
    pub unknowns: DeviceList,
    /// `r`
    pub residual: DeviceList,
    /// `z`
    pub preconditioned: DeviceList,
    /// Loads by which single spheres resist the residual of stiff pairs, and the same as the residual from which the
    /// preconditioner's own iteration starts at rest.
    pub stiff_loads: [DeviceList; 2],
}

/// Known loads, six numbers a particle, and ambient motions of the fluid, eleven numbers a particle, if there are any,
/// in a background with a rate of strain.
#[derive(Debug, Clone, Copy)]
pub struct KnownInput {
    /// Loads.
    pub loads: DeviceList,
    /// Motions.
    pub ambient: Option<DeviceList>,
    /// Components xx, xy, xz, yy and yz.
    pub background: [f64; 5],
}

impl SplitFarField {
    /// Prepares a solve: places of its loads and motions of the far field.
    pub fn begin_coupled(&mut self, background: [f64; 5]) -> Result<(), DeviceError> {
        let Self { device, tables, task, buffers, repeated, .. } = self;
        let (on, value, count) = (device.as_mut(), tables.numbers.size(), task.particles as usize);
        let [forces, torques, stresslets] = &mut buffers.loads;
        task.forces = forces.reserve(on, 3 * count * value)?;
        task.torques = torques.reserve(on, 3 * count * value)?;
        task.stresslets = stresslets.reserve(on, 5 * count * value)?;
        let [velocities, turns, strains] = &mut buffers.motions;
        task.velocities = velocities.reserve(on, 3 * count * value)?;
        task.angular_velocities = turns.reserve(on, 3 * count * value)?;
        task.strain_rates = strains.reserve(on, 5 * count * value)?;
        task.background = background;
        *repeated = Default::default();
        Ok(())
    }

    /// Runs a kernel with a thread a particle.
    pub(crate) fn launch_particles(&mut self, kernel: &str, task: &KernelTask) -> Result<(), DeviceError> {
        self.launch_vectors(kernel, self.blocks(), task)
    }

    /// Unknowns of some motions and of the loads of near pairs in them, whose stresslets are there already.
    pub fn start_unknowns(
        &mut self,
        [motions, loads]: [&DeviceList; 2],
        unknowns: &DeviceList,
    ) -> Result<(), DeviceError> {
        let (direction, image, unknowns) = (motions.address, loads.address, unknowns.address);
        self.launch_particles("start_all", &KernelTask { unknowns, direction, image, ..self.task })
    }

    /// Residual of unknowns, with known loads and motions.
    pub fn start_residual(
        &mut self,
        [unknowns, residual]: [&DeviceList; 2],
        known: &KnownInput,
        factors: &LoadFactors,
        orders: &Orders,
    ) -> Result<(), DeviceError> {
        let suffix = self.tables.numbers.suffix();
        let direction = unknowns.address;
        let (x_factor, y_factor) = (factors.force, factors.torque);
        let task = KernelTask { direction, ambient: known.loads.address, x_factor, y_factor, ..self.task };
        self.launch_particles(&format!("coupled_loads_{suffix}"), &task)?;
        self.evaluate_in_order(orders)?;
        let (x_factor, y_factor) = (factors.velocity, factors.rate);
        let ambient = known.ambient.map_or(0, |list| list.address);
        let list_sums = self.reserve_sums(0, 4 * self.blocks())?;
        let task = KernelTask { direction, ambient, x_factor, y_factor, image_sign: -1.0, list_sums, ..self.task };
        let task = KernelTask { image: residual.address, ..task };
        self.launch_particles(&format!("coupled_image_{suffix}"), &task)
    }

    /// Image of a direction, and the product of both.
    pub fn curvature(
        &mut self,
        [direction, image]: [&DeviceList; 2],
        factors: &LoadFactors,
        orders: &Orders,
    ) -> Result<f64, DeviceError> {
        if self.blocks() == 0 {
            return Ok(0.0);
        }
        let addresses = [direction.address, image.address];
        let (factors, orders) = (*factors, *orders);
        self.repeat(EVALUATION, &addresses, |field| field.apply_coupled(addresses, &factors, &orders))?;
        let [product] = self.totals()?;
        Ok(product)
    }

    /// Kernels of [`Self::curvature`], on lists at two addresses.
    fn apply_coupled(
        &mut self,
        [direction, image]: [u64; 2],
        factors: &LoadFactors,
        orders: &Orders,
    ) -> Result<(), DeviceError> {
        let suffix = self.tables.numbers.suffix();
        let (x_factor, y_factor) = (factors.force, factors.torque);
        let task = KernelTask { direction, x_factor, y_factor, ..self.task };
        self.launch_particles(&format!("coupled_loads_{suffix}"), &task)?;
        self.evaluate_in_order(orders)?;
        let (x_factor, y_factor) = (factors.velocity, factors.rate);
        let blocks = self.blocks();
        let list_sums = self.reserve_sums(0, 4 * blocks)?;
        let task = KernelTask { list_sums, direction, image, x_factor, y_factor, ..self.task };
        let task = KernelTask { image_sign: 1.0, background: [0.0; 5], ..task };
        self.launch_particles(&format!("coupled_image_{suffix}"), &task)?;
        self.launch_sums(list_sums, blocks, 1)
    }

    /// Takes a step, if there is one, and preconditions the residual except that of stiff pairs.
    pub fn step_coupled(&mut self, at: &CoupledVectors, step: Option<&DeviceStep>) -> Result<(), DeviceError> {
        let task = self.coupled_task(at)?;
        self.launch_particles("step_all", &task.with_step(step))?;
        let motions = 6 * self.task.particles as usize;
        let soft = at.residual.part(motions, motions);
        self.pair_loads(PairSet::Soft, [&soft, &at.preconditioned.part(3 * motions, motions)])
    }

    /// Inner products after [`Self::step_coupled`] and the preconditioning of the residual of stiff pairs. The error is
    /// that of motions of single spheres under the loads, the size that of motions and stresslets, weighted by the
    /// resistances.
    pub fn measure_coupled(&mut self, at: &CoupledVectors) -> Result<ProductSums, DeviceError> {
        let task = self.coupled_task(at)?;
        self.launch_particles("measure_all", &task)?;
        self.sum_up(task.list_sums, self.blocks())
    }

    fn coupled_task(&mut self, at: &CoupledVectors) -> Result<KernelTask, DeviceError> {
        let blocks = self.blocks();
        let list_sums = self.reserve_sums(0, 4 * blocks)?;
        let [stiff_loads, stiff_residual] = at.stiff_loads.map(|list| list.address);
        let (unknowns, residual) = (at.unknowns.address, at.residual.address);
        let preconditioned = at.preconditioned.address;
        let task = KernelTask { unknowns, residual, preconditioned, stiff_loads, stiff_residual, ..self.task };
        Ok(KernelTask { list_sums, list_size: blocks as i64, ..task })
    }

    /// Motions, loads on the far field, minus the stresslets, rates of strain besides the background's, and first
    /// moments of lubrication by the motions: lists of six, six, five, five and five numbers a particle.
    pub fn coupled_result(&mut self, at: &CoupledVectors) -> Result<Vec<f64>, DeviceError> {
        let result = self.wide_list(RESULTS * self.task.particles as usize)?;
        let task = KernelTask { image: result.address, ..self.coupled_task(at)? };
        self.launch_particles("gather_all", &task)?;
        let mut values = self.values_of(&result)?;
        values.extend(self.near_moments(&result.part(0, 6 * self.task.particles as usize))?);
        self.release(&result);
        Ok(values)
    }
}
