//! Adaptation of the contact stiffness during a run.

use super::Dynamics;
use crate::forces::contacts::{Contacts, StiffnessAdaptation};
use domain::Particles;

impl Dynamics {
    /// State of the stiffness adaptation, if the stiffness adapts.
    pub fn settling(&self) -> Option<StiffnessAdaptation> {
        self.contacts.as_ref().and_then(Contacts::how_it_settles)
    }

    /// Returns to an earlier state of the adaptation.
    pub fn settle_at(&mut self, settling: Option<StiffnessAdaptation>) {
        self.contacts.iter_mut().for_each(|contacts| contacts.settle_at(settling));
    }

    /// Stiffness of contacts; `None` for spheres without contacts.
    pub fn contact_stiffness(&self) -> Option<f64> {
        self.contacts.as_ref().map(Contacts::stiffness)
    }

    /// Adapts the stiffness of contacts after a substep, unless the adaptation is over. Collective.
    pub fn settle(&mut self, particles: &Particles, step: f64) {
        let (place, strain) = ((self.moving.cell(), &self.partition), self.moving.rate() * step);
        self.contacts.iter_mut().for_each(|contacts| contacts.adapt(particles, place, strain));
    }
}
