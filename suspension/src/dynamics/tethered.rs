//! What bonds, traps and single contacts do between steps.

use super::Dynamics;
use crate::contacts::{self, FORCE_NUMBERS};
use crate::step_error::StepError;
use domain::{Particles, Tensor};

impl Dynamics {
    /// Breaks the bonds that pull too much at the end of a step. Collective.
    pub fn break_bonds(&self, particles: &mut Particles, step: u64) -> Result<(), StepError> {
        let broken = self.tethers.break_bonds(particles, (self.cell(), &self.partition));
        broken.map_err(|source| StepError::Bonds { step, source })
    }

    /// Each particle's share of the first moments of bonds, or nothing without. Collective.
    pub fn bond_moments(&self, particles: &Particles) -> Vec<Tensor> {
        self.tethers.moments(particles, (self.cell(), &self.partition), None)
    }

    /// The elastic energy of bonds and how many of them are broken, if there are any. Collective.
    pub fn bond_numbers(&self, particles: &Particles) -> Option<[f64; 2]> {
        self.tethers.bond_numbers(particles, (self.cell(), &self.partition))
    }

    /// The energy of what is trapped, if anything is. Collective.
    pub fn trap_energy(&self, particles: &Particles) -> Option<f64> {
        self.tethers.trap_energy(particles, (self.cell(), &self.partition))
    }

    /// The contacts and bonds of this rank's particles, in rows of numbers, if there can be any. Collective.
    pub fn contact_forces(&self, particles: &Particles) -> Option<Vec<[f64; FORCE_NUMBERS]>> {
        let place = (self.cell(), &self.partition);
        let contacts = self.contacts.as_ref().map(|contacts| contacts.forces(particles, place));
        let bonds = self.tethers.bond_forces(particles, place);
        let bonds = bonds.map(|bonds| bonds.iter().map(contacts::force_numbers).collect::<Vec<_>>());
        [contacts, bonds].into_iter().flatten().reduce(|all, more| [all, more].concat())
    }
}
