//! Bonds, traps and individual contacts between steps.

use super::Dynamics;
use crate::error::step::StepError;
use crate::forces::contacts::{self, FORCE_NUMBERS};
use domain::{Particles, Tensor};

impl Dynamics {
    /// Breaks bonds with too large a tension at the end of a step. Collective.
    pub fn break_bonds(&self, particles: &mut Particles, step: u64) -> Result<(), StepError> {
        let broken = self.tethers.break_bonds(particles, (self.cell(), &self.partition));
        broken.map_err(|source| StepError::Bonds { step, source })
    }

    /// Contribution of each particle to the first moments of bonds; empty without bonds. Collective.
    pub fn bond_moments(&self, particles: &Particles) -> Vec<Tensor> {
        self.tethers.moments(particles, (self.cell(), &self.partition), None)
    }

    /// Elastic energy of the bonds and number of broken bonds; `None` without bonds. Collective.
    pub fn bond_numbers(&self, particles: &Particles) -> Option<[f64; 2]> {
        self.tethers.bond_numbers(particles, (self.cell(), &self.partition))
    }

    /// Energy of the trapped spheres; `None` without traps. Collective.
    pub fn trap_energy(&self, particles: &Particles) -> Option<f64> {
        self.tethers.trap_energy(particles, (self.cell(), &self.partition))
    }

    /// Contacts and bonds of this rank's particles, as rows of numbers; `None` without either. Collective.
    pub fn contact_forces(&self, particles: &Particles) -> Option<Vec<[f64; FORCE_NUMBERS]>> {
        let place = (self.cell(), &self.partition);
        let contacts = self.contacts.as_ref().map(|contacts| contacts.forces(particles, place));
        let bonds = self.tethers.bond_forces(particles, place);
        let bonds = bonds.map(|bonds| bonds.iter().map(contacts::force_numbers).collect::<Vec<_>>());
        [contacts, bonds].into_iter().flatten().reduce(|all, more| [all, more].concat())
    }
}
