//! Bonds, traps and individual contacts between steps.

use super::Dynamics;
use crate::error::step::StepError;
use crate::forces::contacts::{self, FORCE_NUMBERS};
use crate::forces::tethers::{BondTotals, Bonds, MovingBonds};
use domain::{DomainView, Particles};

/// Error of positions, over the length of a bond, up to which bonds are followed well.
const STRICT: f64 = 0.01;

impl Dynamics {
    /// Ends a step for all forces, for example by breaking bonds. Collective.
    pub fn end_forces(&mut self, particles: &mut Particles, step: u64) -> Result<(), StepError> {
        let Self { forces, moving, partition, .. } = self;
        forces.end_step(particles, DomainView { cell: moving.cell(), partition }, step)
    }

    /// Energies of stretching, bending and twisting of the bonds, and number of broken bonds; `None` without bonds.
    /// Collective.
    pub fn bond_totals(&self, particles: &Particles) -> Option<BondTotals> {
        self.forces.bonds.as_ref().map(|bonds| bonds.totals(particles, self.domain()))
    }

    /// Bonds with velocities in the named columns, if they may need shorter steps than an error of `tolerance` radii of
    /// the positions, and none otherwise or if errors are not limited; `None` if one is as long as half of the box.
    /// Collective.
    pub fn moving_bonds<const N: usize>(
        &self,
        particles: &mut Particles,
        columns: [&str; N],
        tolerance: f64,
    ) -> Option<MovingBonds<N>> {
        let is_loose =
            |bonds: &&Bonds| tolerance.is_finite() && tolerance * self.largest_radius > STRICT * bonds.shortest();
        match self.forces.bonds.as_ref().filter(is_loose) {
            Some(bonds) => bonds.moving(particles, columns, self.domain(), self.forces.lists()),
            None => Some(MovingBonds::NONE),
        }
    }

    /// Energy of the trapped spheres; `None` without traps. Collective.
    pub fn trap_energy(&self, particles: &Particles) -> Option<f64> {
        self.forces.traps.as_ref().map(|traps| traps.energy(particles, self.domain()))
    }

    /// Contacts and bonds of this rank's particles, as rows of numbers; `None` without either. Collective.
    pub fn contact_forces(&self, particles: &Particles) -> Option<Vec<[f64; FORCE_NUMBERS]>> {
        let (domain, lists) = (self.domain(), self.forces.lists());
        let contacts = self.forces.contacts.as_ref().map(|contacts| contacts.forces(particles, domain, lists));
        let bonds = self.forces.bonds.as_ref().map(|bonds| bonds.forces(particles, domain));
        let bonds = bonds.map(|bonds| bonds.iter().map(contacts::force_numbers).collect::<Vec<_>>());
        [contacts, bonds].into_iter().flatten().reduce(|all, more| [all, more].concat())
    }
}
