//! Vectors of the coupled solve of near pairs and far field on a device, see `gpu/kernels/coupled.h`.

use crate::device::DeviceError;
use crate::far_field::{Orders, SplitFarField};
use crate::lists::DeviceList;
use crate::near::{Around, PairLimits, PairSolve, PairVectors};
use crate::numbers::{COUPLED_SUMS, KernelNumbers, SolveSettings};
use crate::pair_rows::PairSet;
use crate::repeated::CommandList;
use crate::task::{DeviceAddress, KernelTask};

/// Numbers of a particle in the unknowns: minus its motion in the loads of stiff pairs, these loads, the same of soft
/// pairs, six numbers each, and minus its stresslet.
pub const UNKNOWNS: usize = 4 * 6 + 5;

/// Numbers of a particle in a residual: motions for stiff and for soft pairs, and the rate of strain.
pub const RESIDUALS: usize = 2 * 6 + 5;

/// Numbers of a particle in the result without the first moment: motion, load on the far field, minus the stresslet,
/// and rate of strain.
pub(crate) const RESULTS: usize = 2 * 6 + 2 * 5;

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
    /// Vectors of the preconditioner, of which given loads and residual are loads by which single spheres resist the
    /// residual of stiff pairs.
    pub stiff: PairVectors,
}

/// A direction `p` of the iteration, and its image `A p`.
#[derive(Debug, Clone, Copy)]
pub struct CoupledDirection {
    /// `p`
    pub direction: DeviceList,
    /// `A p`
    pub image: DeviceList,
    /// Part of the last direction in the next one, `z + turn p`. Without one, the last direction may be undefined.
    pub turn: f64,
    /// `r z` before the step.
    pub product: f64,
}

/// Motions, six numbers a particle, the loads of near pairs in them, and minus the stresslets, from which a solve
/// starts.
#[derive(Debug, Clone, Copy)]
pub struct StartInput {
    /// Motions.
    pub motions: DeviceList,
    /// Loads.
    pub loads: DeviceList,
    /// Minus the stresslets.
    pub moments: DeviceList,
}

/// Inner products after a step: `r z`, `r` times the `z` before the step, and the squares of the error and of the sizes
/// of the unknowns and of `z`. The error is that of motions of single spheres under the loads, the size that of motions
/// and stresslets, weighted by the resistances.
pub type CoupledSums = [f64; COUPLED_SUMS];

/// Known loads, six numbers a particle, and ambient motions of the fluid, eleven numbers a particle, if there are any.
#[derive(Debug, Clone, Copy)]
pub struct KnownInput {
    /// Loads.
    pub loads: DeviceList,
    /// Motions.
    pub ambient: Option<DeviceList>,
}

impl SplitFarField {
    /// Prepares a solve: places of its loads and motions of the far field, and factors of their units.
    pub fn begin_coupled(&mut self, background: [f64; 5], factors: &LoadFactors) -> Result<(), DeviceError> {
        self.place_loads(true)?;
        self.place_motions([true; 2])?;
        let &LoadFactors { force, torque, velocity, rate } = factors;
        self.set_numbers(&KernelNumbers { background, force, torque, velocity, rate, ..self.numbers })
    }

    /// Runs a kernel with a thread a particle.
    pub(crate) fn launch_particles(&mut self, kernel: &str, task: &KernelTask) -> Result<(), DeviceError> {
        self.launch_vectors(kernel, self.blocks(), task)
    }

    /// Unknowns and residual of a start, with known loads and motions.
    pub fn start_coupled(
        &mut self,
        [unknowns, residual]: [&DeviceList; 2],
        start: &StartInput,
        known: &KnownInput,
        orders: &Orders,
    ) -> Result<(), DeviceError> {
        let ambient = known.ambient.map_or(0, |list| list.address);
        let [motions, loads, moments] = [start.motions, start.loads, start.moments].map(|list| list.address);
        let [unknowns, image, given] = [unknowns.address, residual.address, known.loads.address];
        let (suffix, orders) = (self.tables.numbers.suffix(), *orders);
        self.repeat(CommandList::Residual, &[motions, loads, moments, unknowns, image, given, ambient], |field| {
            let task = KernelTask { unknowns, direction: motions, image: loads, list_x: moments, ..field.task };
            field.launch_particles("start_all", &task)?;
            let task = KernelTask { direction: unknowns, ambient: given, ..field.task };
            field.launch_particles(&format!("coupled_loads_{suffix}"), &task)?;
            field.evaluate_in_order(&orders)?;
            let (list_sums, is_residual) = (field.sums(0), 1);
            let task = KernelTask { direction: unknowns, image, ambient, list_sums, is_residual, ..field.task };
            field.launch_particles(&format!("coupled_image_{suffix}"), &task)
        })
    }

    /// Preconditions the residual, and measures it.
    pub fn measure_coupled(&mut self, at: &CoupledVectors, limits: PairLimits) -> Result<CoupledSums, DeviceError> {
        let settings = SolveSettings::new(limits.tolerance);
        self.step_within(at, settings, limits, CommandList::Measure, |field| field.launch_step(at, None))
    }

    /// An iteration: the next direction and its image, the step along it, and the preconditioned residual with its
    /// measures.
    pub fn iterate_coupled(
        &mut self,
        at: &CoupledVectors,
        along: &CoupledDirection,
        limits: PairLimits,
        orders: &Orders,
    ) -> Result<CoupledSums, DeviceError> {
        let &CoupledDirection { turn, product, .. } = along;
        let settings = SolveSettings { turn, product, ..SolveSettings::new(limits.tolerance) };
        let orders = *orders;
        self.step_within(at, settings, limits, CommandList::Iteration, |field| {
            field.launch_turn(at, along, &orders)?;
            field.launch_step(at, Some(along))
        })
    }

    /// Takes a step by some commands, and preconditions and measures the residual.
    fn step_within(
        &mut self,
        at: &CoupledVectors,
        settings: SolveSettings,
        limits: PairLimits,
        recording: CommandList,
        step: impl Fn(&mut Self) -> Result<(), DeviceError>,
    ) -> Result<CoupledSums, DeviceError> {
        let solve = self.stiff_solve(at);
        let &PairSolve { motions, loads, vectors: PairVectors { given, residual, .. }, .. } = &solve;
        let around = Around {
            before: step,
            after: |field: &mut Self| {
                field.remainder([&given, &residual], Some(&motions), &loads)?;
                field.launch_measure(at)
            },
            recordings: [recording, CommandList::MoreSteps],
            addresses: vec![at.unknowns.address, at.residual.address],
        };
        Ok(self.solve_within(&solve, &around, settings, limits)?.sums)
    }

    /// Solves the preconditioner's system to a smaller error.
    pub fn refine_coupled(&mut self, at: &CoupledVectors, limits: PairLimits) -> Result<(), DeviceError> {
        let solve = self.stiff_solve(at);
        self.continue_pairs(&solve, limits)
    }

    /// The solve of the preconditioner, whose motions and loads are parts of the preconditioned residual.
    fn stiff_solve(&self, at: &CoupledVectors) -> PairSolve {
        let numbers = 6 * self.task.particles as usize;
        let [motions, loads] = [0, 1].map(|part| at.preconditioned.part(part * numbers, numbers));
        PairSolve { pairs: PairSet::Stiff, motions, loads, vectors: at.stiff }
    }

    /// The next direction and its image, with their product.
    fn launch_turn(
        &mut self,
        at: &CoupledVectors,
        along: &CoupledDirection,
        orders: &Orders,
    ) -> Result<(), DeviceError> {
        let suffix = self.tables.numbers.suffix();
        let (direction, preconditioned) = (along.direction.address, at.preconditioned.address);
        let task = KernelTask { direction, next_direction: direction, preconditioned, ..self.task };
        self.launch_particles(&format!("coupled_loads_{suffix}"), &task)?;
        self.evaluate_in_order(orders)?;
        let (image, list_sums) = (along.image.address, self.sums(0));
        let task = KernelTask { list_sums, direction, image, ..self.task };
        self.launch_particles(&format!("coupled_image_{suffix}"), &task)
    }

    /// The step along a direction, if there is one, and the preconditioned residual except that of stiff pairs.
    fn launch_step(&mut self, at: &CoupledVectors, along: Option<&CoupledDirection>) -> Result<(), DeviceError> {
        let [direction, image] = along.map_or([0; 2], |along| [along.direction.address, along.image.address]);
        let task = KernelTask { direction, image, ..self.coupled_task(at) };
        self.launch_particles("step_all", &task)?;
        let motions = 6 * self.task.particles as usize;
        let soft = at.residual.part(motions, motions);
        self.launch_rows(PairSet::Soft, false, [&soft, &at.preconditioned.part(3 * motions, motions)])
    }

    /// Sums after a step and the preconditioning of the residual of stiff pairs.
    fn launch_measure(&mut self, at: &CoupledVectors) -> Result<(), DeviceError> {
        let (task, totals) = (self.coupled_task(at), self.sums_of_state());
        self.launch_particles("measure_all", &task)?;
        self.launch_sums(task.list_sums, self.blocks(), COUPLED_SUMS, totals)
    }

    fn coupled_task(&self, at: &CoupledVectors) -> KernelTask {
        let PairVectors { given, residual, .. } = at.stiff;
        let (stiff_loads, stiff_residual) = (given.address, residual.address);
        let (unknowns, residual) = (at.unknowns.address, at.residual.address);
        let (preconditioned, list_sums, blocks) = (at.preconditioned.address, self.sums(0), self.blocks() as i64);
        let task = KernelTask { unknowns, residual, preconditioned, stiff_loads, stiff_residual, ..self.task };
        KernelTask { list_sums, list_size: blocks, block_sums: list_sums, block_count: blocks, ..task }
    }

    /// Result after the preconditioned residual as a last correction: motions, loads on the far field, minus the
    /// stresslets, and rates of strain besides the background's: lists of six, six, five and five numbers a particle,
    /// and first moments of lubrication by the motions, five numbers a particle.
    pub(crate) fn gather_coupled(
        &mut self,
        at: &CoupledVectors,
        result: &DeviceList,
        moments: DeviceAddress,
    ) -> Result<(), DeviceError> {
        let task = KernelTask { image: result.address, ..self.coupled_task(at) };
        self.launch_particles("gather_all", &task)?;
        self.launch_moments(&result.part(0, 6 * self.task.particles as usize), moments)
    }
}
