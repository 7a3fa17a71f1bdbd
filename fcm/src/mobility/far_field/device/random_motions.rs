//! Random motions on a device.

use super::present::PresentLoads;
use super::vectors::SharedField;
use super::{DeviceFarField, succeeded};
use crate::lanczos::{DrawDiagnostics, KrylovBasis, KrylovStep, LanczosLimits, coordinates_of_root};
use crate::mobility::far_field::FarField;
use crate::mobility::loads::{Loads, Motion};
use crate::mobility::noise::NoiseRequest;
use crate::mobility::noise_root::{
    MOST_ITERATIONS, Scales, in_units, of_motion, root_by_loads, root_of_whole, scales_of_classes, sum_in_units,
};
use crate::plan::problem::Multipoles;
use domain::parallel::mapped;
use domain::{Boundaries, Traceless, Vector};
use gpu::{DeviceMotion, KrylovOperator, MOST_VECTORS, Orders, ParticleDraw};
use std::convert::Infallible;

const _: () = assert!(MOST_ITERATIONS <= MOST_VECTORS, "the basis of a square root fits on a device");

/// Basis of Lanczos' iteration on a device.
struct ResidentBasis<'a> {
    field: &'a SharedField,
    operator: KrylovOperator,
    orders: Orders,
}

impl KrylovBasis for ResidentBasis<'_> {
    type Error = Infallible;

    /// Does not use the norm, which is on the device.
    fn extend(&mut self, _: f64) -> Result<KrylovStep, Infallible> {
        let [diagonal, rest] = succeeded(self.field.borrow_mut().extend_basis(self.operator, &self.orders));
        Ok(KrylovStep { diagonal, rest })
    }
}

impl DeviceFarField {
    /// Random motions as of [`crate::mobility::FarField::noise`]. In a periodic box the part on the grid is drawn on
    /// the device. The square root of the pair corrections, and in all other boxes that of the whole mobility, is
    /// applied by Lanczos' iteration.
    pub(super) fn random_motion(&mut self, draw: &NoiseRequest) -> (Motion, DrawDiagnostics) {
        if self.halo.is_alone() { self.resident_motion(draw) } else { self.motion_of_ranks(draw) }
    }

    /// Random motions of a single rank: all random numbers and vectors are on the device, and the host gets two
    /// numbers of each iteration.
    fn resident_motion(&mut self, draw: &NoiseRequest) -> (Motion, DrawDiagnostics) {
        let drawn = self.draw_on_device(draw);
        let motion = as_it_is(&succeeded(self.split.borrow_mut().copy_motion()));
        (in_units(motion, self.plan.multipoles, &self.units), drawn)
    }

    /// Draws these motions, which stay on the device.
    pub(super) fn draw_on_device(&mut self, draw: &NoiseRequest) -> DrawDiagnostics {
        let (own, has_dipoles) = (self.plan.in_units(&self.units), self.has_dipoles());
        let scales = scales_of_classes(&own.radii, own.viscosity);
        let (orders, operator) = (self.orders_of_noise(), self.operator_of_root());
        let input = ParticleDraw { ids: draw.ids, seed: draw.stream.seed_of_particles(), scales: &scales, has_dipoles };
        let norm = succeeded(self.split.borrow_mut().draw_numbers(&input));
        let limits = LanczosLimits { tolerance: draw.tolerance, iterations: MOST_ITERATIONS };
        let mut basis = ResidentBasis { field: &self.split, operator, orders };
        let (coordinates, drawn) = if norm == 0.0 {
            Default::default()
        } else {
            let Ok(root) = coordinates_of_root(&mut basis, norm, limits);
            root
        };
        let mut split = self.split.borrow_mut();
        match operator {
            KrylovOperator::Pairs => succeeded(split.random_field(draw.stream.seed_of_field(), &orders)),
            KrylovOperator::Whole => succeeded(split.clear_motions()),
        }
        succeeded(split.add_from_basis(&coordinates));
        drop(split);
        match operator {
            KrylovOperator::Pairs => self.note_pair_corrections(&drawn),
            KrylovOperator::Whole => self.note_evaluations(drawn.iterations as u64, [has_dipoles; 2]),
        }
        drawn
    }

    /// Random motions of several ranks, whose vectors are on the host: products are on their devices.
    fn motion_of_ranks(&mut self, draw: &NoiseRequest) -> (Motion, DrawDiagnostics) {
        let classes: Vec<u32> = self.particles.radii.iter().map(|&a| self.plan.class_of(a)).collect();
        if self.operator_of_root() == KrylovOperator::Whole {
            let (comm, plan) = (self.partition.comm().clone(), self.plan.clone());
            return root_of_whole(&comm, &plan, &classes, draw, |loads, output| self.apply(loads, output));
        }
        let (orders, has_dipoles) = (self.orders_of_noise(), self.has_dipoles());
        let field = {
            let mut split = self.split.borrow_mut();
            succeeded(split.random_field(draw.stream.seed_of_field(), &orders));
            as_it_is(&succeeded(split.copy_motion()))
        };
        let own = self.plan.in_units(&self.units);
        let scales = Scales::new(&own.radii, own.viscosity, &classes);
        let near = |loads: &Loads| {
            let present = PresentLoads::new(loads, [1.0; 2], [true, has_dipoles, has_dipoles], &self.halo);
            as_it_is(&succeeded(self.split.borrow_mut().pair_corrections(&present.lists(), &orders)))
        };
        let multipoles = self.plan.multipoles;
        let (near, drawn) = root_by_loads(self.partition.comm(), &scales, draw, multipoles, near);
        let of_field = of_motion(&field, has_dipoles);
        self.note_pair_corrections(&drawn);
        (sum_in_units(draw.ids.len(), of_field, &near, multipoles, &self.units), drawn)
    }

    /// Operator of which Lanczos' iteration takes the square root.
    fn operator_of_root(&self) -> KrylovOperator {
        if self.plan.boundaries == Boundaries::Periodic { KrylovOperator::Pairs } else { KrylovOperator::Whole }
    }

    fn orders_of_noise(&self) -> Orders {
        let kinds = [true, self.has_dipoles()];
        self.tables.orders(kinds, kinds)
    }

    fn has_dipoles(&self) -> bool {
        self.plan.multipoles == Multipoles::Dipole
    }

    /// Adds a random field and the products of a square root of the pair corrections to the work.
    fn note_pair_corrections(&mut self, drawn: &DrawDiagnostics) {
        self.work.transforms += 1;
        self.work.neighbours += (self.split.borrow().neighbours() * drawn.iterations) as u64;
    }
}

/// Motions in the units of a device.
fn as_it_is(motion: &DeviceMotion) -> Motion {
    let vectors = |values: &[f64]| mapped(values.as_chunks().0, |&v| Vector::from_array(v));
    Motion {
        velocities: vectors(&motion.velocities),
        angular_velocities: vectors(&motion.angular_velocities),
        strain_rates: mapped(motion.strain_rates.as_chunks().0, |&e| Traceless(e)),
    }
}
