//! Bonds between listed spheres.

use super::beam::{BeamStiffness, BondLoad};
use super::bond::{Bond, BondKind, BondTotals, ExpectedMotion, OwnBeam, Tied};
use super::moving_bonds::MovingBonds;
use crate::columns::{BEAM_END_NUMBERS, BEAM_ENDS, BOND_NUMBERS, BONDS};
use crate::error::step::StepError;
use crate::forces::acting::{Acting, Configuration, Instant, Prediction};
use crate::forces::force::{Force, StressName};
use crate::model::Model;
use crate::neighbourhood::{LocalParticles, NeighbourLists};
use crate::rotation;
use domain::parallel::RowLists;
use domain::{Comm, DomainView, ExpectedCounts, Failure, Particles, PeriodicBox, Quaternion, Tensor, Vector};
use fcm::Loads;
use hydrodynamics::BondSprings;
use simulation::ContactForce;

/// Bonds are implicit up to this multiple of the longest rest length; longer ones contribute their predicted force
/// explicitly.
const IMPLICIT: f64 = 1.25;

/// Invariant that the end of each step establishes.
const KNOWN: &str = "bonds are shorter than half of the box between steps";

/// The bonds of a suspension.
pub struct Bonds {
    kinds: Vec<BondKind>,
    /// Longest rest length; 0 before [`Self::start`].
    longest: f64,
    /// Shortest rest length.
    shortest: f64,
    /// Width of the columns [`BONDS`] and [`BEAM_ENDS`].
    numbers: usize,
    /// Whether some bonds resist bending.
    have_beams: bool,
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

impl Bonds {
    /// The bonds of a model, before [`Self::start`].
    pub fn of(model: &Model) -> Option<Self> {
        let kind = |bonds: &crate::model::Bonds| BondKind {
            stiffness: bonds.stiffness,
            breaking_force: bonds.breaking_force.unwrap_or(f64::INFINITY),
            beam: bonds.beam.map(|beam| BeamStiffness { bending: beam.bending, twisting: beam.twisting }),
        };
        let (kinds, half) = (model.bonds.iter().map(kind).collect(), 0.5 * model.shortest_vector());
        let numbers = model.bond_numbers() + model.beam_end_numbers();
        let bonds = Self { kinds, longest: 0.0, shortest: 0.0, numbers, have_beams: model.has_beams(), half };
        (!model.bonds.is_empty()).then_some(bonds)
    }

    /// Whether some bonds resist bending.
    pub fn have_beams(&self) -> bool {
        self.have_beams
    }

    /// Takes the rest lengths from the particles' column. Collective.
    pub fn start(&mut self, particles: &Particles, comm: &Comm) {
        let lengths = || slots(particles).map(|(_, slot)| slot[1]);
        // The greatest of the negative lengths is that of the shortest bond.
        let mut greatest = [lengths().fold(0.0, f64::max), lengths().fold(f64::NEG_INFINITY, |most, l| most.max(-l))];
        comm.max(&mut greatest);
        (self.longest, self.shortest) = (greatest[0], -greatest[1]);
    }

    /// Shortest rest length.
    pub fn shortest(&self) -> f64 {
        self.shortest
    }

    /// Bonds with velocities in the named columns; `None` if one is as long as half of the box. Collective.
    pub fn moving<const N: usize>(
        &self,
        particles: &mut Particles,
        columns: [&str; N],
        domain: DomainView,
        lists: &NeighbourLists,
    ) -> Option<MovingBonds<N>> {
        let tied = self.find(particles, domain, lists).ok()?;
        Some(MovingBonds::of(&tied, particles, columns))
    }

    /// Energies of stretching, bending and twisting, and number of broken bonds. Collective.
    pub fn totals(&self, particles: &Particles, domain: DomainView) -> BondTotals {
        let tied = self.find(particles, domain, &NeighbourLists::default()).expect(KNOWN);
        let [stretching, bending, twisting] = tied.energies();
        let mut sums = [stretching, bending, twisting, broken(particles)];
        domain.comm().sum(&mut sums);
        let [stretching, bending, twisting, broken] = sums;
        BondTotals { stretching, bending, twisting, broken }
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
            if let Some(mut list) = found.filter(|_| !is_missing) {
                self.add_beams(&mut list, particles, &present);
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
                beam: None,
            })
        };
        whole().map(bond).collect()
    }

    /// Sets the beams of bonds that resist bending. Collective.
    fn add_beams(&self, list: &mut [Bond], particles: &Particles, present: &LocalParticles) {
        if !self.have_beams {
            return;
        }
        let orientations = present.extended(rotation::known(particles));
        let ends = particles.columns.iter().find(|column| column.name == BEAM_ENDS).map_or(&[][..], |c| &c.values);
        let ends: &[[Quaternion; 2]] = bytemuck::cast_slice(ends.as_chunks::<BEAM_END_NUMBERS>().0);
        for bond in list {
            let oriented = bond.rows.map(|row| orientations[row]);
            bond.beam = OwnBeam::of(bond, particles.ids[bond.rows[0]], oriented, ends[bond.slot]);
        }
    }

    /// Adds the known part of the loads. With `w` the motions of the two spheres, for a tension the rate at which their
    /// centres separate, `w*` the expected ones and `K` the stiffness, the loads after a time `t` are
    /// `F(x*) + t K (w - w*)`.
    fn add(&self, loads: &mut Loads, tied: &Tied, ahead: Option<&Prediction>) {
        loads.forces.resize(tied.present.owned(), Vector::ZERO);
        if self.have_beams {
            loads.torques.resize(tied.present.owned(), Vector::ZERO);
        }
        let expected = ahead.map(|ahead| self.expected(tied, ahead));
        for bond in &tied.list {
            let (row, load) = (bond.rows[0], self.load(bond, expected.as_ref(), -1.0));
            loads.forces[row] += load.force;
            if self.have_beams {
                loads.torques[row] += load.torque;
            }
        }
    }

    /// Expected motions of particles and ghosts. Collective.
    fn expected<'a>(&self, tied: &Tied, prediction: &'a Prediction<'a>) -> ExpectedMotion<'a> {
        let velocities = tied.present.extended(prediction.velocities);
        let angular_velocities =
            if self.have_beams { tied.present.extended(prediction.angular_velocities) } else { [].as_slice().into() };
        ExpectedMotion { velocities, angular_velocities, prediction }
    }

    /// Load of a bond on its particle, changed by `times` that of the implicit resistances in the expected motion.
    fn load(&self, bond: &Bond, expected: Option<&ExpectedMotion>, times: f64) -> BondLoad {
        match expected {
            Some(expected) => bond.load_ahead(expected, self.is_implicit(bond), times),
            None => bond.load(),
        }
    }

    fn is_implicit(&self, bond: &Bond) -> bool {
        bond.distance() <= self.implicit_reach()
    }

    /// Implicit resistances of the bonds, particle by particle.
    fn springs(&self, tied: &Tied, time: f64) -> RowLists<BondSprings> {
        let list = &tied.list[..];
        let spring = |bond: &Bond| {
            let time = if self.is_implicit(bond) { time } else { 0.0 };
            let [bending, twisting] = bond.beam_stiffness().map_or([0.0; 2], |beam| [beam.bending, beam.twisting]);
            BondSprings {
                other: bond.other,
                within: self.half,
                resistance: time * bond.kind.stiffness,
                bending: 4.0 * time * bending,
                twisting: time * twisting,
            }
        };
        let first = |row: usize| list.partition_point(|bond| bond.rows[0] < row);
        RowLists::of_rows(tied.present.owned(), |row, springs| {
            springs.extend(list[first(row)..first(row + 1)].iter().map(spring));
        })
    }

    /// First moments of the bonds: a pair at `x_i` and `x_j` with the force `F` on the first contributes
    /// `-(x_i - x_j) F / 2` to each. The torques of beams cancel the antisymmetric parts. Collective.
    fn first_moments(&self, tied: &Tied, beyond: Option<&Prediction>) -> Vec<Tensor> {
        let mut moments = vec![Tensor::ZERO; tied.present.owned()];
        let expected = beyond.map(|ahead| self.expected(tied, ahead));
        for bond in &tied.list {
            let (r, force) = (bond.separation, self.load(bond, expected.as_ref(), 1.0).force);
            let moment = Tensor::from_cols(r * force.x, r * force.y, r * force.z) * 0.5;
            let is_symmetric = bond.beam.is_none();
            moments[bond.rows[0]] += if is_symmetric { moment } else { (moment + moment.transpose()) * 0.5 };
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
