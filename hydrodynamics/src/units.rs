//! Scaling of the lubrication problem to units in which radii and viscosity are about 1. Without it, the square roots
//! of both in the amplitudes of the modes would lose their last digit when powers of two change the units.

use crate::six_vector::SixVector;
use crate::solution::{NO_AMBIENT, StoredSolution};
use crate::springs::{BondSprings, TetherResistance};
use crate::springs::{ContactSprings, Springs};
use domain::parallel::{FusedLoops, RowLists, mapped};
use domain::{Particles, Traceless, Units, Vector};
use fcm::{Loads, Mobility, Motion, Multipoles, Output};
use lubrication::PairKind;

/// A mobility in scaled units.
pub struct Scaled<'a> {
    pub mobility: &'a mut Mobility,
    pub units: Units,
}

impl Scaled<'_> {
    /// Motions, in the units of the mobility, due to a load on each of `count` particles and to stresslets that are
    /// minus the first moments, as in [`Mobility::apply`], and to degenerate quadrupoles in these units.
    pub fn apply(
        &mut self,
        count: usize,
        load: impl Fn(usize) -> SixVector + Sync,
        moments: &[Traceless],
        quadrupoles: Option<&[Vector]>,
    ) -> Motion {
        let is_rigid = self.mobility.plan().multipoles == Multipoles::Dipole;
        let (mut loads, torque, load) = (Loads::default(), self.units.torque(), &load);
        let mut loops = FusedLoops::default();
        loops.of_rows(&mut loads.forces, count, move |row| load(row).linear());
        if is_rigid {
            loops.of_rows(&mut loads.torques, count, move |row| load(row).angular() * torque);
            loops.mapped(&mut loads.stresslets, moments, move |&d| -d * torque);
        }
        loops.run();
        match quadrupoles {
            Some(quadrupoles) => self.mobility.apply_with_quadrupoles(&loads, quadrupoles),
            None => self.mobility.apply(&loads, if is_rigid { Output::All } else { Output::Velocities }),
        }
    }

    /// A motion in the units of the mobility.
    pub fn far_motion<'a>(&self, motion: &'a Motion) -> FarMotion<'a> {
        let [velocity, rate] = [self.units.velocity(), self.units.rate()].map(|unit| 1.0 / unit);
        FarMotion { motion, ambient: &NO_AMBIENT, velocity, rate }
    }
}

/// Motions of particles in scaled units: those of the far field in other units, and scaled ambient motions.
#[derive(Clone, Copy)]
pub struct FarMotion<'a> {
    motion: &'a Motion,
    ambient: &'a Motion,
    /// Factors of velocities and of rates.
    velocity: f64,
    rate: f64,
}

impl<'a> FarMotion<'a> {
    /// Together with ambient motions in scaled units; empty lists stand for none.
    pub fn with(self, ambient: &'a Motion) -> Self {
        Self { ambient, ..self }
    }

    /// Number of strain rates.
    pub fn strained(&self) -> usize {
        self.motion.strain_rates.len()
    }

    /// Velocity and angular velocity of a particle.
    pub fn rigid(&self, row: usize) -> SixVector {
        let sum = |motions: [&[Vector]; 2], factor: f64| {
            let [far, ambient] = motions.map(|list| list.get(row).copied());
            let far = far.map(|far| far * factor);
            far.map(|far| ambient.map_or(far, |ambient| far + ambient)).unwrap_or_default()
        };
        let (far, ambient) = (self.motion, self.ambient);
        let angular = sum([&far.angular_velocities, &ambient.angular_velocities], self.rate);
        SixVector::new(sum([&far.velocities, &ambient.velocities], self.velocity), angular)
    }

    /// Strain rate of a particle.
    pub fn strain_rate(&self, row: usize) -> Traceless {
        let far = self.motion.strain_rates[row] * self.rate;
        self.ambient.strain_rates.get(row).map_or(far, |&ambient| far + ambient)
    }
}

/// Spring resistances in scaled units, as a function of distance and surfaces.
pub fn resistance<'a>(springs: &'a Springs<'a>, units: &Units) -> impl Fn(f64, PairKind) -> f64 + Sync + 'a {
    let (length, velocity) = (units.length, units.velocity());
    move |distance, between| (springs.resistance)(distance * length, between.times(length)) * velocity
}

/// Contact springs of a rank's particles in scaled units.
pub fn contacts(springs: &Springs, units: &Units) -> RowLists<ContactSprings> {
    springs.contacts.mapped(|contact| contact.in_units(units))
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
    TetherResistance { bonds: bonds.mapped(bond), traps: mapped(traps, |trap| trap * units.velocity()) }
}

/// Particles in scaled units, without their columns.
pub fn particles(given: &Particles, units: &Units) -> Particles {
    let over = 1.0 / units.length;
    let mut scaled = Particles { scalars: given.scalars.clone(), ..Particles::default() };
    let mut loops = FusedLoops::default();
    loops.copied(&mut scaled.ids, &given.ids);
    loops.mapped(&mut scaled.positions, &given.positions, move |&x| x * over);
    loops.copied(&mut scaled.steps, &given.steps);
    loops.mapped(&mut scaled.radii, &given.radii, move |&a| a * over);
    loops.copied(&mut scaled.species, &given.species);
    loops.run();
    scaled
}

/// Loads with torques and stresslets in another unit; the unit of forces is unchanged.
pub fn times(loads: &Loads, torque: f64) -> Loads {
    let mut made = Loads::default();
    let mut loops = FusedLoops::default();
    loops.copied(&mut made.forces, &loads.forces);
    loops.mapped(&mut made.torques, &loads.torques, move |&t| t * torque);
    loops.mapped(&mut made.stresslets, &loads.stresslets, move |&s| s * torque);
    loops.run();
    made
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
        stresslets_far: mapped(&given.stresslets_far, |&s| s * torque),
        stresslets: mapped(&given.stresslets, |&s| s * torque),
    }
}

fn motion_times(motion: &Motion, velocity: f64, rate: f64) -> Motion {
    let (mut made, mut loops) = (Motion::default(), FusedLoops::default());
    motion_in(&mut loops, &mut made, motion, [velocity, rate]);
    loops.run();
    made
}

/// Makes a motion whose velocities and rates are multiplied, as three of several loops.
pub fn motion_in<'a>(loops: &mut FusedLoops<'a>, made: &'a mut Motion, motion: &'a Motion, [velocity, rate]: [f64; 2]) {
    loops.mapped(&mut made.velocities, &motion.velocities, move |&v| v * velocity);
    loops.mapped(&mut made.angular_velocities, &motion.angular_velocities, move |&w| w * rate);
    loops.mapped(&mut made.strain_rates, &motion.strain_rates, move |&e| e * rate);
}
