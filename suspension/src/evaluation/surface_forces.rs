//! Forces between surfaces that are added where the far field is evaluated.

use super::Dynamics;
use crate::bodies;
use domain::Particles;

impl Dynamics {
    /// Leaves the forces of pairs between surfaces to the solver, if its back end adds them up: those of free spheres,
    /// in steps that do not need these pairs here. Other steps leave them to it while particles move there. Pairs
    /// within a rigid body have no forces.
    pub(super) fn leave_surface_forces(&mut self, particles: &Particles) {
        let Self { forces, hydrodynamics, largest_radius, needs_pairs, .. } = self;
        if bodies::exist(particles) {
            return;
        }
        if *needs_pairs {
            let taken = forces.between_surfaces();
            if !taken.is_empty() {
                hydrodynamics.take_surface_forces(&taken);
            }
        } else {
            forces.leave_surfaces(*largest_radius, |laws| hydrodynamics.take_surface_forces(laws));
        }
    }
}

#[cfg(test)]
impl Dynamics {
    /// Continues with a device that evaluates the far field.
    pub fn evaluate_on(&mut self, device: Box<dyn gpu::Device>, particles: &Particles) {
        let plan = self.hydrodynamics.mobility().plan().clone();
        let mobility = fcm::Mobility::on(device, &plan, &self.partition);
        self.hydrodynamics.set_far_field(fcm::StressletSolver::of(mobility, self.partition.comm()));
        self.leave_surface_forces(particles);
    }
}
