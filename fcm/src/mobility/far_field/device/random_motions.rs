//! Random motions on a device.

use super::present::PresentLoads;
use super::{DeviceFarField, succeeded};
use crate::mobility::far_field::FarField;
use crate::mobility::loads::{Loads, Motion};
use crate::mobility::noise::{DrawDiagnostics, NoiseRequest};
use crate::mobility::noise_root::{Scales, of_motion, root_by_loads, root_of_whole, sum_in_units};
use crate::plan::problem::Multipoles;
use domain::{Boundaries, Vector};
use gpu::DeviceMotion;

impl DeviceFarField {
    /// Random motions as of [`crate::mobility::FarField::noise`], by the random numbers of the host. In a periodic box
    /// the part on the grid is drawn on the device. The square root of the pair corrections, and in all other boxes
    /// that of the whole mobility, is applied by Lanczos' iteration, whose vectors are on the host and whose products
    /// are on the device.
    pub(super) fn random_motion(&mut self, draw: &NoiseRequest) -> (Motion, DrawDiagnostics) {
        let classes: Vec<u32> = self.particles.radii.iter().map(|&a| self.plan.class_of(a)).collect();
        if self.plan.boundaries != Boundaries::Periodic {
            let (comm, plan) = (self.partition.comm().clone(), self.plan.clone());
            return root_of_whole(&comm, &plan, &classes, draw, |loads, output| self.apply(loads, output));
        }
        let multipoles = self.plan.multipoles;
        let has_dipoles = multipoles == Multipoles::Dipole;
        let orders = self.tables.orders([true, has_dipoles], [true, has_dipoles]);
        let field = succeeded(self.split.borrow_mut().random_field(draw.stream.seed_of_field(), &orders));
        let own = self.plan.in_units(&self.units);
        let scales = Scales::new(&own.radii, own.viscosity, &classes);
        let near = |loads: &Loads| {
            let present = PresentLoads::new(loads, [1.0; 2], [true, has_dipoles, has_dipoles], &self.halo);
            as_it_is(&succeeded(self.split.borrow_mut().pair_corrections(&present.lists(), &orders)))
        };
        let (near, drawn) = root_by_loads(self.partition.comm(), &scales, draw, multipoles, near);
        let of_field = of_motion(&as_it_is(&field), has_dipoles).into_iter();
        let motion = sum_in_units(of_field, &near, multipoles, &self.units);
        self.work.transforms += 1;
        self.work.neighbours += (self.split.borrow().neighbours() * drawn.iterations) as u64;
        (motion, drawn)
    }
}

/// Motions in the units of a device.
fn as_it_is(motion: &DeviceMotion) -> Motion {
    let vectors = |values: &[f64]| values.as_chunks().0.iter().map(|&v| Vector::from_array(v)).collect();
    Motion {
        velocities: vectors(&motion.velocities),
        angular_velocities: vectors(&motion.angular_velocities),
        strain_rates: motion.strain_rates.as_chunks().0.iter().map(|&e| domain::Traceless(e)).collect(),
    }
}
