//! Bonds between listed spheres, and traps: springs that act at any distance.

mod bonds;
mod start;
mod traps;

pub use bonds::Bonds;
use bonds::Tied;
pub use start::{check, tie};
pub use traps::{TRAP_NUMBERS, Traps};

use crate::forces::Prediction;
use crate::model::Model;
use domain::{Comm, Failure, Particles, Partition, PeriodicBox, Tensor};
use fcm::Loads;
use hydrodynamics::TetherResistance;
use simulation::ContactForce;

/// Invariant that the end of each step establishes.
const KNOWN: &str = "bonds are shorter than half of the box between steps";

/// Bonds and traps of a suspension.
pub struct Tethers {
    bonds: Option<Bonds>,
    traps: Option<Traps>,
}

impl Tethers {
    /// Bonds and traps of a model, whose state is in columns of the particles. Collective.
    pub fn new(model: &Model, particles: &Particles, comm: &Comm) -> Self {
        Self { bonds: Bonds::of(model, particles, comm), traps: Traps::of(model) }
    }

    /// Distance of centres up to which bonds are implicit; with traps alone, any distance will do.
    pub fn reach(&self, largest_radius: f64) -> Option<f64> {
        let least = self.traps.as_ref().map(|_| 2.0 * largest_radius);
        self.bonds.as_ref().map(Bonds::implicit_reach).or(least)
    }

    /// Adds the forces of bonds and traps to the loads of this rank's particles. With a prediction `ahead`, these are
    /// the forces at its end, without the implicit part, which the returned [`TetherResistance`] describes. Collective.
    pub fn add_to(
        &self,
        loads: &mut Loads,
        particles: &Particles,
        place: (&PeriodicBox, &Partition),
        ahead: Option<&Prediction>,
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

    /// Adds the present forces, between steps. Collective.
    pub fn add_known(&self, loads: &mut Loads, particles: &Particles, place: (&PeriodicBox, &Partition)) {
        self.add_to(loads, particles, place, None).expect(KNOWN);
    }

    /// First moments of bonds, particle by particle, empty without bonds. With `beyond`, the forces change in
    /// proportion to velocities beyond the expected ones. Bonds must be shorter than half of the box. Collective.
    pub fn moments(
        &self,
        particles: &Particles,
        place: (&PeriodicBox, &Partition),
        beyond: Option<&Prediction>,
    ) -> Vec<Tensor> {
        self.tied(particles, place).map(|(bonds, tied)| bonds.moments(&tied, beyond)).unwrap_or_default()
    }

    /// Breaks bonds with too large a tension. Fails if a bond is as long as half of the box. Collective.
    pub fn break_bonds(&self, particles: &mut Particles, place: (&PeriodicBox, &Partition)) -> Result<(), Failure> {
        if let Some(bonds) = &self.bonds {
            bonds.find(particles, place)?.break_those(particles);
        }
        Ok(())
    }

    /// Elastic energy of the bonds and number of broken bonds; `None` without bonds. Collective.
    pub fn bond_numbers(&self, particles: &Particles, place: (&PeriodicBox, &Partition)) -> Option<[f64; 2]> {
        let (_, tied) = self.tied(particles, place)?;
        let mut sums = [tied.energy(), bonds::broken(particles)];
        place.1.comm().sum(&mut sums);
        Some(sums)
    }

    /// Energy of the trapped spheres; `None` without traps. Collective.
    pub fn trap_energy(&self, particles: &Particles, (cell, partition): (&PeriodicBox, &Partition)) -> Option<f64> {
        let mut sum = [self.traps.as_ref()?.energy(particles, cell)];
        partition.comm().sum(&mut sum);
        Some(sum[0])
    }

    /// Forces of the unbroken bonds of this rank's particles with others of higher id; `None` without bonds.
    /// Collective.
    pub fn bond_forces(&self, particles: &Particles, place: (&PeriodicBox, &Partition)) -> Option<Vec<ContactForce>> {
        self.tied(particles, place).map(|(_, tied)| tied.forces(particles))
    }

    fn tied(&self, particles: &Particles, place: (&PeriodicBox, &Partition)) -> Option<(&Bonds, Tied)> {
        let bonds = self.bonds.as_ref()?;
        Some((bonds, bonds.find(particles, place).expect(KNOWN)))
    }
}
