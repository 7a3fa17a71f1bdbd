//! Bonds between listed spheres.

use crate::columns::{BOND_NUMBERS, BONDS};
use crate::error::step::StepError;
use crate::forces::acting::{Acting, Configuration, Instant, Prediction};
use crate::forces::force::{Force, StressName};
use crate::model::Model;
use crate::neighbourhood::{LocalParticles, NeighbourLists};
use domain::{Comm, DomainView, ExpectedCounts, Failure, Particles, PeriodicBox, Tensor, Vector};
use fcm::Loads;
use hydrodynamics::BondSprings;
use simulation::{ContactForce, ContactState};
use std::rc::Rc;

/// Bonds are implicit up to this multiple of the longest rest length; longer ones contribute their predicted force
/// explicitly.
const IMPLICIT: f64 = 1.25;

/// Invariant that the end of each step establishes.
const KNOWN: &str = "bonds are shorter than half of the box between steps";

/// The bonds of a suspension.
pub struct Bonds {
    kinds: Vec<Kind>,
    /// Longest rest length; 0 before [`Self::start`].
    longest: f64,
    /// Width of the column [`BONDS`].
    numbers: usize,
    /// Half of the shortest edge of the box: an image within this distance is the nearest.
    half: f64,
}

impl Force for Bonds {
    fn name(&self) -> &'static str {
        "bond"
    }

    fn add_present_loads(&self, at: &Configuration, loads: &mut Loads) {
        self.add(loads, &self.find(at.particles, at.domain, at.lists).expect(KNOWN), None);
    }

    /// With a prediction, these are the forces at its end without the implicit part.
    fn add_loads(&mut self, at: &mut Instant, acting: &mut Acting) -> Result<(), Failure> {
        let tied = self.find(at.particles, at.domain, at.lists)?;
        self.add(&mut acting.loads, &tied, at.prediction);
        if let Some(prediction) = at.prediction {
            acting.resistances.add_bonds(self.springs(&tied, prediction.time));
        }
        Ok(())
    }

    fn stresses(&self) -> Vec<StressName> {
        vec![StressName::symmetric("bond")]
    }

    fn moments(&self, at: &Configuration, beyond: Option<&Prediction>) -> Vec<Vec<Tensor>> {
        vec![self.first_moments(&self.find(at.particles, at.domain, at.lists).expect(KNOWN), beyond)]
    }

    fn implicit_range(&self, _largest_radius: f64) -> Option<f64> {
        (self.longest > 0.0).then(|| self.implicit_reach())
    }

    /// Breaks bonds with too large a tension. Fails if a bond is as long as half of the box.
    fn end_step(&mut self, particles: &mut Particles, domain: DomainView) -> Result<(), Failure> {
        self.find(particles, domain, &NeighbourLists::default())?.break_those(particles);
        Ok(())
    }

    fn explain(&self, step: u64, source: Failure) -> StepError {
        StepError::Bonds { step, source }
    }

    fn numbers(&self, _expected: &ExpectedCounts) -> usize {
        self.numbers
    }
}

/// Parameters of a kind of bonds.
#[derive(Debug, Clone, Copy)]
struct Kind {
    stiffness: f64,
    breaking_force: f64,
}

/// A bond as seen by one of its two particles; the other sees the same with the axis reversed, bit for bit.
#[derive(Debug, Clone, Copy)]
struct Bond {
    /// Row of the particle, and row of the other among local particles and ghosts.
    rows: [usize; 2],
    other: u64,
    /// Vector from the particle's centre to the other's nearest image.
    separation: Vector,
    slot: usize,
    kind: Kind,
    length: f64,
}

/// Unbroken bonds of a rank's particles, row by row.
struct Tied {
    present: Rc<LocalParticles>,
    list: Vec<Bond>,
}

impl Bond {
    fn distance(&self) -> f64 {
        self.separation.length()
    }

    /// Tension; negative if the bond is compressed.
    fn pull(&self) -> f64 {
        self.kind.stiffness * (self.distance() - self.length)
    }

    /// Rate at which the centres separate.
    fn separation_rate(&self, velocities: &[Vector], ahead: &Prediction) -> f64 {
        let [own, other] = self.rows;
        let relative = velocities[other] - velocities[own] + ahead.strain_rate.tensor() * self.separation;
        self.separation.dot(relative) / self.distance()
    }
}

impl Tied {
    /// Forces of bonds with particles of higher id.
    fn forces(&self, particles: &Particles) -> Vec<ContactForce> {
        let force = |bond: &Bond| {
            let own = bond.rows[0];
            (particles.ids[own] < bond.other).then(|| ContactForce {
                ids: [particles.ids[own], bond.other],
                position: particles.positions[own],
                separation: bond.separation,
                normal: -bond.pull(),
                tangential: Vector::ZERO,
                state: ContactState::Bond,
            })
        };
        self.list.iter().filter_map(force).collect()
    }

    /// Breaks the bonds whose tension is too large.
    fn break_those(&self, particles: &mut Particles) {
        let Some(column) = particles.columns.iter_mut().find(|column| column.name == BONDS) else { return };
        for bond in self.list.iter().filter(|bond| bond.pull() > bond.kind.breaking_force) {
            column.values[BOND_NUMBERS * bond.slot + 2] *= -1.0;
        }
    }

    /// This rank's share of the elastic energy.
    fn energy(&self) -> f64 {
        self.list.iter().map(|bond| 0.25 * bond.kind.stiffness * (bond.distance() - bond.length).powi(2)).sum()
    }
}

impl Bonds {
    /// The bonds of a model, before [`Self::start`].
    pub fn of(model: &Model) -> Option<Self> {
        let kind = |bonds: &crate::model::Bonds| Kind {
            stiffness: bonds.stiffness,
            breaking_force: bonds.breaking_force.unwrap_or(f64::INFINITY),
        };
        let (kinds, half) = (model.bonds.iter().map(kind).collect(), 0.5 * model.shortest_vector());
        let bonds = Self { kinds, longest: 0.0, numbers: model.bond_numbers(), half };
        (!model.bonds.is_empty()).then_some(bonds)
    }

    /// Takes the rest lengths from the particles' column. Collective.
    pub fn start(&mut self, particles: &Particles, comm: &Comm) {
        let mut longest = [slots(particles).map(|(_, slot)| slot[1]).fold(0.0, f64::max)];
        comm.max(&mut longest);
        self.longest = longest[0];
    }

    /// Elastic energy and number of broken bonds. Collective.
    pub fn energy_and_broken(&self, particles: &Particles, domain: DomainView) -> [f64; 2] {
        let tied = self.find(particles, domain, &NeighbourLists::default()).expect(KNOWN);
        let mut sums = [tied.energy(), broken(particles)];
        domain.comm().sum(&mut sums);
        sums
    }

    /// Forces of the unbroken bonds of this rank's particles with others of higher id. Collective.
    pub fn forces(&self, particles: &Particles, domain: DomainView) -> Vec<ContactForce> {
        self.find(particles, domain, &NeighbourLists::default()).expect(KNOWN).forces(particles)
    }

    fn implicit_reach(&self) -> f64 {
        (IMPLICIT * self.longest).min(self.half)
    }

    /// Finds the unbroken bonds. Fails if one is as long as half of the box, where the image to which it extends is
    /// ambiguous. Collective.
    fn find(&self, particles: &Particles, domain: DomainView, lists: &NeighbourLists) -> Result<Tied, Failure> {
        let comm = domain.comm();
        let mut reach = self.implicit_reach();
        loop {
            let present = lists.present(particles, domain, reach);
            let found = self.among(particles, &present, domain.cell);
            let is_missing = comm.any(found.is_none());
            if let Some(list) = found.filter(|_| !is_missing) {
                let long = list.iter().find(|bond| bond.distance() >= self.half);
                comm.agree(long.map_or(Ok(()), |bond| Err(self.too_long(bond, particles))))?;
                return Ok(Tied { present, list });
            }
            if is_missing && reach >= 2.0 * self.half {
                let message =
                    "a bond is longer than the box is wide; give a larger bonds.stiffness or a shorter time.step";
                comm.agree(Err::<(), _>(message))?;
            }
            reach *= 2.0;
        }
    }

    fn too_long(&self, bond: &Bond, particles: &Particles) -> String {
        format!(
            "the bond of spheres {} and {} is {:.4} long; it needs to be shorter than half of the box's shortest \
             edge, {:.4}",
            particles.ids[bond.rows[0]],
            bond.other,
            domain::Number(bond.distance()),
            domain::Number(self.half)
        )
    }

    /// The bonds, if all bonded particles are among the local particles and ghosts.
    fn among(&self, particles: &Particles, present: &LocalParticles, cell: &PeriodicBox) -> Option<Vec<Bond>> {
        let (positions, ids) = (present.positions(), present.ids());
        let whole = || slots(particles).filter(|(_, slot)| slot[2] > 0.0);
        let mut rows: Vec<(u64, Option<usize>)> = whole().map(|(_, slot)| (slot[0] as u64 - 1, None)).collect();
        rows.sort_unstable();
        rows.dedup();
        for (row, id) in ids.iter().enumerate() {
            if let Ok(place) = rows.binary_search_by_key(id, |(id, _)| *id) {
                rows[place].1 = Some(row);
            }
        }
        let slots_each = particles.columns.iter().find(|c| c.name == BONDS).map_or(1, |c| c.width / BOND_NUMBERS);
        let bond = |(slot, numbers): (usize, &[f64; BOND_NUMBERS])| {
            let (own, other) = (slot / slots_each, numbers[0] as u64 - 1);
            let row = rows[rows.binary_search_by_key(&other, |(id, _)| *id).ok()?].1?;
            Some(Bond {
                rows: [own, row],
                other,
                separation: cell.nearest_image(positions[row] - positions[own]),
                slot,
                kind: self.kinds[numbers[2] as usize - 1],
                length: numbers[1],
            })
        };
        whole().map(bond).collect()
    }

    /// Adds the known part of the tension. With `w` the rate at which the centres separate and `w*` its expected value,
    /// the tension after a time `t` is `F(x*) + t k (w - w*)`.
    fn add(&self, loads: &mut Loads, tied: &Tied, ahead: Option<&Prediction>) {
        loads.forces.resize(tied.present.owned(), Vector::ZERO);
        for (bond, pull) in tied.list.iter().zip(self.pulls(tied, ahead.map(|ahead| (ahead, -1.0)))) {
            loads.forces[bond.rows[0]] += bond.separation * (pull / bond.distance());
        }
    }

    /// Tension of each bond, changed by `times` the implicit resistance times the expected rate of separation.
    /// Collective.
    fn pulls(&self, tied: &Tied, ahead: Option<(&Prediction, f64)>) -> Vec<f64> {
        let Some((ahead, times)) = ahead else { return tied.list.iter().map(Bond::pull).collect() };
        let velocities = tied.present.extended(ahead.velocities);
        let of_one = |bond: &Bond| {
            bond.pull() + times * self.resistance(bond, ahead.time) * bond.separation_rate(&velocities, ahead)
        };
        tied.list.iter().map(of_one).collect()
    }

    fn resistance(&self, bond: &Bond, time: f64) -> f64 {
        if bond.distance() <= self.implicit_reach() { time * bond.kind.stiffness } else { 0.0 }
    }

    /// Implicit resistances of the bonds, particle by particle.
    fn springs(&self, tied: &Tied, time: f64) -> Vec<Vec<BondSprings>> {
        let mut springs = vec![Vec::new(); tied.present.owned()];
        for bond in &tied.list {
            let (within, resistance) = (self.half, self.resistance(bond, time));
            springs[bond.rows[0]].push(BondSprings { other: bond.other, within, resistance });
        }
        springs
    }

    /// First moments of the bonds: a pair at `x_i` and `x_j` with the force `F` on the first contributes
    /// `-(x_i - x_j) F / 2` to each. Collective.
    fn first_moments(&self, tied: &Tied, beyond: Option<&Prediction>) -> Vec<Tensor> {
        let mut moments = vec![Tensor::ZERO; tied.present.owned()];
        for (bond, pull) in tied.list.iter().zip(self.pulls(tied, beyond.map(|ahead| (ahead, 1.0)))) {
            let (r, force) = (bond.separation, bond.separation * (pull / bond.distance()));
            moments[bond.rows[0]] += Tensor::from_cols(r * force.x, r * force.y, r * force.z) * 0.5;
        }
        moments
    }
}

/// Occupied slots of all particles, with unbroken or broken bonds, and their indices in the column.
fn slots(particles: &Particles) -> impl Iterator<Item = (usize, &[f64; BOND_NUMBERS])> {
    let values = particles.columns.iter().find(|column| column.name == BONDS).map_or(&[][..], |c| &c.values);
    values.as_chunks().0.iter().enumerate().filter(|(_, slot)| slot[0] != 0.0)
}

/// This rank's share of the number of broken bonds.
fn broken(particles: &Particles) -> f64 {
    0.5 * slots(particles).filter(|(_, slot)| slot[2] < 0.0).count() as f64
}
