//! Scaling of the lubrication problem to units in which radii and viscosity are about 1. Without it, the square roots
//! of both in the amplitudes of the modes would lose their last digit when powers of two change the units.

use crate::solution::{Guess, Solution, StoredSolution};
use crate::springs::{BondSprings, TetherResistance};
use crate::springs::{ContactSprings, Springs};
use domain::parallel::{copied, mapped};
use domain::{Particles, Traceless, Units, Vector};
use fcm::{Loads, Mobility, Motion, Multipoles, Output};
use lubrication::PairKind;

/// A mobility in scaled units.
pub struct Scaled<'a> {
    pub mobility: &'a mut Mobility,
    pub units: Units,
}

impl Scaled<'_> {
    /// Motions due to loads, as in [`Mobility::apply`].
    pub fn apply(&mut self, loads: &Loads) -> Motion {
        let motion = match self.mobility.plan().multipoles {
            Multipoles::Dipole => self.mobility.apply(&times(loads, self.units.torque()), Output::All),
            Multipoles::Monopole | Multipoles::Moments => {
                let forces = Loads { forces: loads.forces.clone(), ..Loads::default() };
                self.mobility.apply(&forces, Output::Velocities)
            }
        };
        self::motion(&motion, &self.units)
    }

    /// Motions due to loads and degenerate quadrupoles, as in [`Mobility::apply_with_quadrupoles`]; the quadrupoles are
    /// in the units of the mobility.
    pub fn apply_with_quadrupoles(&mut self, loads: &Loads, quadrupoles: &[Vector]) -> Motion {
        let loads = times(loads, self.units.torque());
        motion(&self.mobility.apply_with_quadrupoles(&loads, quadrupoles), &self.units)
    }
}

/// Spring resistances in scaled units, as a function of distance and surfaces.
pub fn resistance<'a>(springs: &'a Springs<'a>, units: &Units) -> impl Fn(f64, PairKind) -> f64 + Sync + 'a {
    let (length, velocity) = (units.length, units.velocity());
    move |distance, between| (springs.resistance)(distance * length, between.times(length)) * velocity
}

/// Contact springs of a rank's particles in scaled units.
pub fn contacts(springs: &Springs, units: &Units) -> Vec<Vec<ContactSprings>> {
    let of_one = |all: &Vec<ContactSprings>| all.iter().map(|contact| contact.times(units.velocity())).collect();
    mapped(springs.contacts, of_one)
}

/// Bonds and traps of a rank's particles in scaled units.
pub fn tethers(springs: &Springs, units: &Units) -> TetherResistance {
    let TetherResistance { bonds, traps } = springs.tethers;
    let bond = |bond: &BondSprings| BondSprings {
        within: bond.within / units.length,
        resistance: bond.resistance * units.velocity(),
        bending: bond.bending * (units.rate() / units.torque()),
        twisting: bond.twisting * (units.rate() / units.torque()),
        ..*bond
    };
    TetherResistance {
        bonds: mapped(bonds, |all| all.iter().map(bond).collect()),
        traps: mapped(traps, |trap| trap * units.velocity()),
    }
}

/// Particles in scaled units, without their columns.
pub fn particles(given: &Particles, units: &Units) -> Particles {
    let over = 1.0 / units.length;
    Particles {
        ids: copied(&given.ids),
        positions: mapped(&given.positions, |&x| x * over),
        steps: copied(&given.steps),
        radii: mapped(&given.radii, |&a| a * over),
        species: copied(&given.species),
        columns: Vec::new(),
        scalars: given.scalars.clone(),
    }
}

/// The initial guess in scaled units.
pub fn guess(given: &Guess, units: &Units) -> Guess {
    let times = |list: &[Vector], unit: f64| mapped(list, |&v| v * (1.0 / unit));
    Guess {
        stresslets_far: tensors_times(&given.stresslets_far, 1.0 / units.torque()),
        induced_velocities: times(&given.induced_velocities, units.velocity()),
        induced_angular_velocities: times(&given.induced_angular_velocities, units.rate()),
        velocities: times(&given.velocities, units.velocity()),
        angular_velocities: times(&given.angular_velocities, units.rate()),
    }
}

/// A solution in the original units.
pub fn solution(found: &Solution, units: &Units) -> Solution {
    Solution {
        motion: motion_back(&found.motion, units),
        stresslets: tensors_times(&found.stresslets, units.torque()),
        far: times(&found.far, units.torque()),
        constraint_loads: times(&found.constraint_loads, units.torque()),
        induced: motion_back(&found.induced, units),
        curvature: found.curvature * units.rate() / units.length,
        iterations: found.iterations,
        residual: found.residual,
    }
}

/// Loads with torques and stresslets in another unit; the unit of forces is unchanged.
pub fn times(loads: &Loads, torque: f64) -> Loads {
    Loads {
        forces: copied(&loads.forces),
        torques: mapped(&loads.torques, |&t| t * torque),
        stresslets: tensors_times(&loads.stresslets, torque),
    }
}

/// Motions in scaled units.
pub fn motion(given: &Motion, units: &Units) -> Motion {
    motion_times(given, 1.0 / units.velocity(), 1.0 / units.rate())
}

/// Motions in the original units.
pub fn motion_back(found: &Motion, units: &Units) -> Motion {
    motion_times(found, units.velocity(), units.rate())
}

/// A solution in scaled units.
pub fn found(given: &StoredSolution, units: &Units) -> StoredSolution {
    let torque = 1.0 / units.torque();
    StoredSolution {
        motion: motion(&given.motion, units),
        stresslets_far: tensors_times(&given.stresslets_far, torque),
        stresslets: tensors_times(&given.stresslets, torque),
    }
}

fn motion_times(motion: &Motion, velocity: f64, rate: f64) -> Motion {
    Motion {
        velocities: mapped(&motion.velocities, |&v| v * velocity),
        angular_velocities: mapped(&motion.angular_velocities, |&w| w * rate),
        strain_rates: tensors_times(&motion.strain_rates, rate),
    }
}

fn tensors_times(list: &[Traceless], factor: f64) -> Vec<Traceless> {
    mapped(list, |&t| t * factor)
}
