//! Ends of bonds that resist bending, at the start of a run.

use crate::columns::{BEAM_END_NUMBERS, BOND_NUMBERS};
use crate::model::{Beam, Model, RestShape, without_orientation};
use crate::rotation;
use domain::{Particles, PeriodicBox, Quaternion, Vector};

/// Sum of the directions of two bonds below which their sphere has no direction of its chain.
const FOLDED: f64 = 1e-6;

/// The column [`BEAM_ENDS`](crate::columns::BEAM_ENDS) of all particles with these bonds; empty without bonds that
/// resist bending.
pub fn of_all(all: &Particles, bonds: &[f64], model: &Model, cell: &PeriodicBox) -> Result<Vec<f64>, String> {
    if !model.has_beams() {
        return Ok(Vec::new());
    }
    let start = BeamStart { all, bonds: bonds.as_chunks().0, slots: model.most_bonds(), model, cell };
    let mut values = vec![0.0; BEAM_END_NUMBERS * start.bonds.len()];
    for (slot, ends) in values.as_chunks_mut::<BEAM_END_NUMBERS>().0.iter_mut().enumerate() {
        let Some(beam) = start.beam(slot) else { continue };
        let row = slot / start.slots;
        let other = start.other(slot);
        let orientations = [start.orientation(row)?, start.orientation(other)?];
        let axes = start.axes(row, other, beam.rest)?;
        for (k, (axes, orientation)) in axes.into_iter().zip(orientations).enumerate() {
            ends[4 * k..][..4].copy_from_slice(&(orientation.inverse() * axes).normalized().to_array());
        }
    }
    Ok(values)
}

/// All particles at the start, by id, and their bonds.
struct BeamStart<'a> {
    all: &'a Particles,
    bonds: &'a [[f64; BOND_NUMBERS]],
    /// Slots of each particle.
    slots: usize,
    model: &'a Model,
    cell: &'a PeriodicBox,
}

impl BeamStart<'_> {
    fn beam(&self, slot: usize) -> Option<Beam> {
        let kind = self.bonds[slot][2];
        if kind > 0.0 { self.model.bonds[kind as usize - 1].beam } else { None }
    }

    /// Row of the other particle of a bond.
    fn other(&self, slot: usize) -> usize {
        self.bonds[slot][0] as usize - 1
    }

    fn orientation(&self, row: usize) -> Result<Quaternion, String> {
        let found = rotation::known(self.all).get(row).copied().unwrap_or(Quaternion::NONE);
        if found.is_some() {
            return Ok(found);
        }
        let species = &self.model.species[self.all.species[row] as usize].name;
        Err(format!("bonds.bending_stiffness {}", without_orientation(self.all.ids[row], species)))
    }

    /// Direction from one particle to another.
    fn direction(&self, row: usize, other: usize) -> Vector {
        self.cell.nearest_image(self.all.positions[other] - self.all.positions[row]).normalize()
    }

    /// Axes of the ends of a bond at its particle and at the other, without twist. They do not depend on which of the
    /// two it is: their z axes are from the particle with the lower id to the other.
    fn axes(&self, row: usize, other: usize, rest: RestShape) -> Result<[Quaternion; 2], String> {
        if row > other {
            let [first, second] = self.axes(other, row, rest)?;
            return Ok([second, first]);
        }
        let along = match rest {
            RestShape::Start => [self.direction(row, other); 2],
            RestShape::Straight => [self.tangent(row, other)?, -self.tangent(other, row)?],
        };
        let first = Quaternion::between(Vector::Z, along[0]);
        let second = Quaternion::between(along[0], along[1]) * first;
        Ok([first, second])
    }

    /// Direction of a straight chain at one of its particles, on the side of another: the mean of those of its bonds.
    fn tangent(&self, row: usize, other: usize) -> Result<Vector, String> {
        let is_straight = |slot: &usize| self.beam(*slot).is_some_and(|beam| beam.rest == RestShape::Straight);
        let slots = (self.slots * row..self.slots * (row + 1)).filter(is_straight);
        let neighbours: Vec<usize> = slots.map(|slot| self.other(slot)).filter(|&one| one != other).collect();
        let towards = self.direction(row, other);
        let id = self.all.ids[row];
        match neighbours[..] {
            [] => Ok(towards),
            [before] => {
                let sum = towards - self.direction(row, before);
                let folded =
                    format!("bonds.rest_shape is \"straight\", but the chain is folded at sphere {id}; unfold it");
                if sum.length() > FOLDED { Ok(sum.normalize()) } else { Err(folded) }
            }
            _ => Err(format!(
                "bonds.rest_shape is \"straight\", but sphere {id} has {} such bonds; a chain has two there, so take \
                 \"start\"",
                neighbours.len() + 1
            )),
        }
    }
}
