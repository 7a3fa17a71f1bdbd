//! Solve for the stresslets of rigid spheres on a device: all vectors of the iteration stay there.

use super::succeeded;
use super::vectors::{ResidentVector, SharedField};
use crate::conjugate_gradients::{Iterate, IterationOutcome, Limits, System, conjugate_gradients};
use domain::Comm;
use gpu::{DeviceLoads, DeviceMotion, MotionLists, Orders};

/// Problem of rigid spheres in the units of the device.
pub(super) struct ResidentProblem<'a> {
    /// Forces, torques, and stresslets that the iteration starts from.
    pub loads: DeviceLoads<'a>,
    /// Rates of strain besides, five numbers for each sphere.
    pub strain_rates: &'a [f64],
    /// Resistance of single spheres to strain, by class of radius.
    pub resistances: &'a [f64],
    /// Orders of derivatives with all loads and motions, and with stresslets alone.
    pub orders: [Orders; 2],
    /// This rank alone.
    pub comm: &'a Comm,
    /// Limits of the iteration.
    pub limits: Limits<'a>,
}

/// Motion, stresslets and outcome.
pub(super) struct ResidentSolution {
    /// Motion that all loads cause.
    pub motion: DeviceMotion,
    /// Stresslets, five numbers for each sphere.
    pub stresslets: Vec<f64>,
    /// Result of the iteration.
    pub outcome: IterationOutcome,
}

/// System for the stresslets `-D`. The motion follows the iteration.
struct ResidentStrain<'a> {
    field: SharedField,
    resistances: ResidentVector,
    orders: &'a Orders,
    motion: [ResidentVector; 3],
    /// Motion that the last direction causes as a stresslet.
    step: MotionLists,
}

/// Solves a problem from its start.
pub(super) fn solve(field: &SharedField, problem: &ResidentProblem) -> ResidentSolution {
    let start = succeeded(field.borrow_mut().apply(&problem.loads, &problem.orders[0]));
    let residual: Vec<f64> = start.strain_rates.iter().zip(problem.strain_rates).map(|(e, b)| -(e + b)).collect();
    let resisted: Vec<f64> = problem.loads.stresslets.iter().map(|s| -s).collect();
    let [mut residual, mut x] = [&residual, &resisted].map(|values| ResidentVector::of(field, values));
    let mut z = ResidentVector::new(field, 0);
    let parts = [&start.velocities, &start.angular_velocities, &start.strain_rates];
    let mut system = ResidentStrain {
        field: field.clone(),
        resistances: ResidentVector::of(field, problem.resistances),
        orders: &problem.orders[1],
        motion: parts.map(|values| ResidentVector::of(field, values)),
        step: succeeded(field.borrow_mut().motion_lists()),
    };
    let iterate = Iterate { x: &mut x, residual: &mut residual, z: &mut z };
    let outcome = conjugate_gradients(problem.comm, &mut system, iterate, problem.limits);
    let [velocities, angular_velocities, strain_rates] = system.motion.each_ref().map(ResidentVector::values);
    let stresslets = x.values().into_iter().map(|d| -d).collect();
    ResidentSolution { motion: DeviceMotion { velocities, angular_velocities, strain_rates }, stresslets, outcome }
}

impl ResidentStrain<'_> {
    fn contract(&self, x: &ResidentVector, y: &ResidentVector, over: Option<&ResidentVector>) -> f64 {
        succeeded(self.field.borrow_mut().contract(&x.list, &y.list, over.map(|weights| &weights.list)))
    }
}

impl Drop for ResidentStrain<'_> {
    fn drop(&mut self) {
        for list in &self.step {
            self.field.borrow_mut().release(list);
        }
    }
}

impl System for ResidentStrain<'_> {
    type Unknowns = ResidentVector;
    type Residual = ResidentVector;

    fn product(&self, residual: &ResidentVector, x: &ResidentVector) -> f64 {
        self.contract(residual, x, None)
    }

    fn apply(&mut self, direction: &ResidentVector) -> ResidentVector {
        let mut field = self.field.borrow_mut();
        succeeded(field.apply_stresslets(&direction.list, &self.step, self.orders));
        drop(field);
        let image = ResidentVector::new(&self.field, direction.count());
        succeeded(self.field.borrow_mut().combine([-1.0, 0.0], &self.step[2], &image.list));
        image
    }

    fn on_step(&mut self, length: f64) {
        for (part, step) in self.motion.iter().zip(&self.step) {
            succeeded(self.field.borrow_mut().combine([-length, 1.0], step, &part.list));
        }
    }

    fn precondition(&mut self, residual: &ResidentVector) -> ResidentVector {
        let z = ResidentVector::new(&self.field, residual.count());
        succeeded(self.field.borrow_mut().weigh(&self.resistances.list, &residual.list, &z.list));
        z
    }

    fn size(&self, x: &ResidentVector) -> f64 {
        self.contract(x, x, Some(&self.resistances))
    }
}
