//! Bonds between listed spheres and traps: springs that do not ask who is near.

mod bonds;
mod start;
mod traps;

use bonds::Tied;
pub use bonds::{BOND_NUMBERS, Bonds};
pub use start::{check, tie};
pub use traps::{TRAP_NUMBERS, Traps};

use crate::forces::Ahead;
use crate::model::Model;
use domain::{Comm, Failure, Particles, Partition, PeriodicBox, Tensor};
use fcm::Loads;
use hydrodynamics::TetherResistance;
use simulation::ContactForce;

/// What the end of each step makes sure of.
const KNOWN: &str = "bonds are shorter than half of the box between steps";

/// Bonds and traps of a suspension.
pub struct Tethers {
    bonds: Option<Bonds>,
    traps: Option<Traps>,
}

impl Tethers {
    /// Those of a model, in whose particles' columns they are. Collective.
    pub fn new(model: &Model, particles: &Particles, comm: &Comm) -> Self {
        Self { bonds: Bonds::of(model, particles, comm), traps: Traps::of(model) }
    }

    /// The distance of centres up to which bonds are part of a solve; for traps alone any will do.
    pub fn reach(&self, largest_radius: f64) -> Option<f64> {
        let least = self.traps.as_ref().map(|_| 2.0 * largest_radius);
        self.bonds.as_ref().map(Bonds::implicit_reach).or(least)
    }

    /// Adds their forces to the loads of this rank's particles: those at the end of some time, as far as
    /// [`TetherResistance`] does not have them, where that is foretold. Collective.
    pub fn add_to(
        &self,
        loads: &mut Loads,
        particles: &Particles,
        place: (&PeriodicBox, &Partition),
        ahead: Option<&Ahead>,
    ) -> Result<TetherResistance, Failure> {
        let mut resisting = TetherResistance::default();
        if let Some(bonds) = &self.bonds {
            let tied = bonds.find(particles, place)?;
            bonds.add_to(loads, &tied, ahead);
            resisting.bonds = ahead.map(|ahead| bonds.springs(&tied, ahead.time)).unwrap_or_default();
        }
        if let Some(traps) = &self.traps {
            traps.add_to(loads, particles, place.0, ahead);
            resisting.traps = ahead.map(|ahead| traps.resistances(particles, ahead.time)).unwrap_or_default();
        }
        Ok(resisting)
    }

    /// Adds their forces as they are between steps. Collective.
    pub fn add_known(&self, loads: &mut Loads, particles: &Particles, place: (&PeriodicBox, &Partition)) {
        self.add_to(loads, particles, place, None).expect(KNOWN);
    }

    /// Each particle's share of the first moments of bonds, or nothing without; at the end of some time where they change to
    /// velocities beyond those expected. Where they are no longer than they may be. Collective.
    pub fn moments(
        &self,
        particles: &Particles,
        place: (&PeriodicBox, &Partition),
        beyond: Option<&Ahead>,
    ) -> Vec<Tensor> {
        self.tied(particles, place).map(|(bonds, tied)| bonds.moments(&tied, beyond)).unwrap_or_default()
    }

    /// Breaks the bonds that pull too much. Fails where one is as long as half of the box. Collective.
    pub fn break_bonds(&self, particles: &mut Particles, place: (&PeriodicBox, &Partition)) -> Result<(), Failure> {
        if let Some(bonds) = &self.bonds {
            bonds.find(particles, place)?.break_those(particles);
        }
        Ok(())
    }

    /// The elastic energy of bonds and how many of them are broken, if there are any. Collective.
    pub fn bond_numbers(&self, particles: &Particles, place: (&PeriodicBox, &Partition)) -> Option<[f64; 2]> {
        let (_, tied) = self.tied(particles, place)?;
        let mut sums = [tied.energy(), bonds::broken(particles)];
        place.1.comm().sum(&mut sums);
        Some(sums)
    }

    /// The energy of what is trapped, if anything is. Collective.
    pub fn trap_energy(&self, particles: &Particles, (cell, partition): (&PeriodicBox, &Partition)) -> Option<f64> {
        let mut sum = [self.traps.as_ref()?.energy(particles, cell)];
        partition.comm().sum(&mut sum);
        Some(sum[0])
    }

    /// The whole bonds of this rank's particles with others of higher ids, if there can be any. Collective.
    pub fn bond_forces(&self, particles: &Particles, place: (&PeriodicBox, &Partition)) -> Option<Vec<ContactForce>> {
        self.tied(particles, place).map(|(_, tied)| tied.forces(particles))
    }

    fn tied(&self, particles: &Particles, place: (&PeriodicBox, &Partition)) -> Option<(&Bonds, Tied)> {
        let bonds = self.bonds.as_ref()?;
        Some((bonds, bonds.find(particles, place).expect(KNOWN)))
    }
}
