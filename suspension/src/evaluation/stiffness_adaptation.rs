//! Adaptation of the contact stiffness during a run.

use super::Dynamics;
use super::approach::ELSEWHERE;
use crate::forces::contacts::{Contacts, StiffnessAdaptation};
use domain::{DomainView, Particles};
use std::rc::Rc;

impl Dynamics {
    /// State of the stiffness adaptation, if the stiffness adapts.
    pub fn stiffness_adaptation(&self) -> Option<StiffnessAdaptation> {
        self.forces.contacts.as_ref().and_then(Contacts::adaptation)
    }

    /// Returns to an earlier state of the adaptation.
    pub fn set_adaptation(&mut self, adaptation: Option<StiffnessAdaptation>) {
        self.forces.contacts.iter_mut().for_each(|contacts| contacts.set_adaptation(adaptation));
    }

    /// Stiffness of contacts; `None` for spheres without contacts.
    pub fn contact_stiffness(&self) -> Option<f64> {
        self.forces.contacts.as_ref().map(Contacts::stiffness)
    }

    /// Adapts the stiffness of contacts after a substep, unless the adaptation is over. Collective.
    pub fn adapt_stiffness(&mut self, particles: &Particles, step: f64) {
        let Self { forces, moving, partition, hydrodynamics, .. } = self;
        let (domain, strain) = (DomainView { cell: moving.cell(), partition }, moving.rate() * step);
        let lists = Rc::clone(forces.lists());
        let Some(contacts) = forces.contacts.as_mut().filter(|contacts| contacts.are_adapting()) else { return };
        if particles.are_remote() {
            hydrodynamics.mobility().follow(moving.cell(), particles);
            let gap = hydrodynamics.steps().expect(ELSEWHERE).smallest_relative_gap(contacts.reach());
            contacts.adapt_to_gap(gap, strain);
        } else {
            contacts.adapt(particles, domain, &lists, strain);
        }
    }
}
