//! Solve for the stresslets of rigid spheres on a device: all vectors of the iteration stay there.

use super::succeeded;
use super::vectors::{ResidentVector, SharedField};
use crate::conjugate_gradients::{
    InnerProducts, Iterate, IterationOutcome, Limits, SteppedSystem, Turn, conjugate_gradients,
};
use domain::Comm;
use gpu::{DeviceLoads, DeviceMotion, MotionLists, Orders, StrainSums, StrainVectors};

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
    motion: ResidentVector,
    /// Motion that the last direction causes as a stresslet.
    step: MotionLists,
}

/// Solves a problem from its start.
pub(super) fn solve(field: &SharedField, problem: &ResidentProblem) -> ResidentSolution {
    let start = succeeded(field.borrow_mut().apply(&problem.loads, &problem.orders[0]));
    let DeviceMotion { velocities, angular_velocities, strain_rates } = start;
    let residual: Vec<f64> = strain_rates.iter().zip(problem.strain_rates).map(|(e, b)| -(e + b)).collect();
    let resisted: Vec<f64> = problem.loads.stresslets.iter().map(|s| -s).collect();
    let numbers = velocities.len();
    let [mut residual, mut x] = [&residual, &resisted].map(|values| ResidentVector::of(field, values));
    let mut z = ResidentVector::new(field, residual.count());
    let mut system = ResidentStrain {
        field: field.clone(),
        resistances: ResidentVector::of(field, problem.resistances),
        orders: &problem.orders[1],
        motion: ResidentVector::of(field, &[velocities, angular_velocities, strain_rates].concat()),
        step: succeeded(field.borrow_mut().motion_lists()),
    };
    let iterate = Iterate { x: &mut x, residual: &mut residual, z: &mut z };
    let outcome = conjugate_gradients(problem.comm, &mut system, iterate, problem.limits);
    let motion = system.motion.values();
    let (velocities, gradients) = motion.split_at(numbers);
    let (angular_velocities, strain_rates) = gradients.split_at(numbers);
    let [velocities, angular_velocities, strain_rates] =
        [velocities, angular_velocities, strain_rates].map(<[f64]>::to_vec);
    let stresslets = x.values().into_iter().map(|d| -d).collect();
    ResidentSolution { motion: DeviceMotion { velocities, angular_velocities, strain_rates }, stresslets, outcome }
}

impl ResidentStrain<'_> {
    fn vectors(&self, Iterate { x, residual, z }: Iterate<ResidentVector, ResidentVector>) -> StrainVectors {
        StrainVectors {
            unknowns: x.list,
            residual: residual.list,
            preconditioned: z.list,
            resistances: self.resistances.list,
            motion: self.motion.list,
            step: self.step,
        }
    }
}

/// The error is measured by `r z`.
fn products([former, product, size]: StrainSums) -> InnerProducts {
    InnerProducts { product, former, error: product, size }
}

impl Drop for ResidentStrain<'_> {
    fn drop(&mut self) {
        for list in &self.step {
            self.field.borrow_mut().release(list);
        }
    }
}

impl SteppedSystem for ResidentStrain<'_> {
    type Unknowns = ResidentVector;
    type Residual = ResidentVector;

    fn refine_preconditioner(&mut self) -> bool {
        false
    }

    fn measure(&mut self, at: Iterate<ResidentVector, ResidentVector>) -> InnerProducts {
        products(succeeded(self.field.borrow_mut().measure_strain(&self.vectors(at))))
    }

    fn advance(
        &mut self,
        _: &Comm,
        at: Iterate<ResidentVector, ResidentVector>,
        direction: &mut Option<ResidentVector>,
        Turn { factor, product }: Turn,
    ) -> InnerProducts {
        let numbers = at.x.count();
        let turn = if direction.is_some() { factor } else { 0.0 };
        let direction = direction.get_or_insert_with(|| ResidentVector::new(&self.field, numbers)).list;
        let (at, mut field) = (self.vectors(at), self.field.borrow_mut());
        products(succeeded(field.iterate_strain(&at, &direction, [turn, product], self.orders)))
    }
}
