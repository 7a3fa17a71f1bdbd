//! Contacts whose stiffness adapts.

use super::Dynamics;
use crate::contacts::{Contacts, Settling};
use domain::Particles;

impl Dynamics {
    /// How the stiffness of contacts adapts, if it does.
    pub fn settling(&self) -> Option<Settling> {
        self.contacts.as_ref().and_then(Contacts::how_it_settles)
    }

    /// Goes back to a stiffness of the past.
    pub fn settle_at(&mut self, settling: Option<Settling>) {
        self.contacts.iter_mut().for_each(|contacts| contacts.settle_at(settling));
    }

    /// The stiffness of contacts, if there can be any.
    pub fn contact_stiffness(&self) -> Option<f64> {
        self.contacts.as_ref().map(Contacts::stiffness)
    }

    /// Adapts the stiffness of contacts, while it does, after a substep. Collective.
    pub fn settle(&mut self, particles: &Particles, step: f64) {
        let (place, strain) = ((self.moving.cell(), &self.partition), self.moving.rate() * step);
        self.contacts.iter_mut().for_each(|contacts| contacts.adapt(particles, place, strain));
    }
}
