//! A bond at one time, as seen by one of its spheres.

use super::beam::{BeamEnd, BeamStiffness, BentBeam, BondLoad, BondMotion};
use crate::columns::{BOND_NUMBERS, BONDS};
use crate::forces::acting::Prediction;
use crate::neighbourhood::LocalParticles;
use domain::{Particles, Quaternion, Vector};
use simulation::{ContactForce, ContactState};
use std::borrow::Cow;
use std::rc::Rc;

/// Parameters of a kind of bonds.
#[derive(Debug, Clone, Copy)]
pub struct BondKind {
    pub stiffness: f64,
    pub breaking_force: f64,
    /// `EI` and `GJ`; `None` for bonds that do not resist bending.
    pub beam: Option<BeamStiffness>,
}

/// A bond as seen by one of its two particles; the other sees the same with the axis reversed, bit for bit.
#[derive(Debug, Clone, Copy)]
pub struct Bond {
    /// Row of the particle, and row of the other among local particles and ghosts.
    pub rows: [usize; 2],
    pub other: u64,
    /// Vector from the particle's centre to the other's nearest image.
    pub separation: Vector,
    pub slot: usize,
    pub kind: BondKind,
    pub length: f64,
    pub beam: Option<OwnBeam>,
}

/// The beam of a bond, whose first end is at the sphere of the lower id.
#[derive(Debug, Clone, Copy)]
pub struct OwnBeam {
    bent: BentBeam,
    /// End at the particle, 0 or 1.
    end: usize,
}

/// Expected motions of particles and ghosts.
pub struct ExpectedMotion<'a> {
    pub velocities: Cow<'a, [Vector]>,
    pub angular_velocities: Cow<'a, [Vector]>,
    pub prediction: &'a Prediction<'a>,
}

impl OwnBeam {
    /// The beam of a bond without it, between spheres of these orientations, for the quaternions of its ends in the
    /// axes of the spheres. Both spheres see the same, bit for bit.
    pub fn of(bond: &Bond, own: u64, orientations: [Quaternion; 2], ends: [Quaternion; 2]) -> Option<Self> {
        let BeamStiffness { bending, twisting } = bond.kind.beam?;
        let stiffness = BeamStiffness { bending: bending / bond.length, twisting: twisting / bond.length };
        let [here, there] = [0, 1].map(|k| BeamEnd::of(orientations[k] * ends[k]));
        let bent = if own < bond.other {
            BentBeam { separation: bond.separation, ends: [here, there], stiffness }
        } else {
            BentBeam { separation: -bond.separation, ends: [there, here], stiffness }
        };
        Some(Self { bent, end: usize::from(own > bond.other) })
    }
}

impl Bond {
    pub fn distance(&self) -> f64 {
        self.separation.length()
    }

    /// Tension; negative if the bond is compressed.
    pub fn pull(&self) -> f64 {
        self.kind.stiffness * (self.distance() - self.length)
    }

    /// Load on the particle with a given tension.
    fn pulled(&self, pull: f64) -> BondLoad {
        let bent = self.beam.map_or_else(BondLoad::default, |beam| beam.bent.load(beam.end));
        BondLoad { force: self.separation * (pull / self.distance()) + bent.force, ..bent }
    }

    /// Load on the particle.
    pub fn load(&self) -> BondLoad {
        self.pulled(self.pull())
    }

    /// Load on the particle, changed by `times` that of the implicit resistances in the expected motion.
    pub fn load_ahead(&self, expected: &ExpectedMotion, is_implicit: bool, times: f64) -> BondLoad {
        if !is_implicit {
            return self.load();
        }
        let ([own, other], ahead) = (self.rows, expected.prediction);
        let strained = ahead.strain_rate.tensor() * self.separation;
        let relative = expected.velocities[other] - expected.velocities[own] + strained;
        let separation_rate = self.separation.dot(relative) / self.distance();
        let mut load = self.pulled(self.pull() + times * (ahead.time * self.kind.stiffness) * separation_rate);
        if let Some(stiffness) = self.beam_stiffness() {
            let angular_velocities = self.rows.map(|row| expected.angular_velocities[row]);
            let resisted = stiffness.resist(self.separation, &BondMotion { relative, angular_velocities });
            load.force += resisted.force * (times * ahead.time);
            load.torque += resisted.torque * (times * ahead.time);
        }
        load
    }

    /// `EI/l` and `GJ/l`; `None` for a bond that does not resist bending.
    pub fn beam_stiffness(&self) -> Option<BeamStiffness> {
        self.beam.map(|beam| beam.bent.stiffness)
    }
}

/// Energies of all bonds, and the number of broken ones.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BondTotals {
    /// Energy of stretching.
    pub stretching: f64,
    /// Energy of bending.
    pub bending: f64,
    /// Energy of twisting.
    pub twisting: f64,
    /// Number of broken bonds.
    pub broken: f64,
}

/// Unbroken bonds of a rank's particles, row by row.
pub struct Tied {
    pub present: Rc<LocalParticles>,
    pub list: Vec<Bond>,
}

impl Tied {
    /// Forces of bonds with particles of higher id.
    pub fn forces(&self, particles: &Particles) -> Vec<ContactForce> {
        let force = |bond: &Bond| {
            let own = bond.rows[0];
            (particles.ids[own] < bond.other).then(|| ContactForce {
                ids: [particles.ids[own], bond.other],
                position: particles.positions[own],
                separation: bond.separation,
                normal: -bond.pull(),
                tangential: bond.beam.map_or(Vector::ZERO, |beam| beam.bent.load(beam.end).force),
                state: ContactState::Bond,
            })
        };
        self.list.iter().filter_map(force).collect()
    }

    /// Breaks the bonds whose tension is too large.
    pub fn break_those(&self, particles: &mut Particles) {
        let Some(column) = particles.columns.iter_mut().find(|column| column.name == BONDS) else { return };
        for bond in self.list.iter().filter(|bond| bond.pull() > bond.kind.breaking_force) {
            column.values[BOND_NUMBERS * bond.slot + 2] *= -1.0;
        }
    }

    /// This rank's share of the energies of stretching, bending and twisting.
    pub fn energies(&self) -> [f64; 3] {
        let of_one = |bond: &Bond| {
            let [bent, twisted] = bond.beam.map_or([0.0; 2], |beam| beam.bent.energies());
            let stretched = 0.25 * bond.kind.stiffness * (bond.distance() - bond.length).powi(2);
            [stretched, 0.5 * bent, 0.5 * twisted]
        };
        let add = |[a, b, c]: [f64; 3], [d, e, f]: [f64; 3]| [a + d, b + e, c + f];
        self.list.iter().map(of_one).fold([0.0; 3], add)
    }
}
