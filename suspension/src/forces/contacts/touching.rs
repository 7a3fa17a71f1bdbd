//! Contacts of a rank's particles.

use super::history::{CONTACTS, Memory, recall};
use crate::neighbourhood::{LocalParticles, NearParticles};
use domain::parallel::{FusedLoops, RowLists};
use domain::{Column, Neighbour, Neighbours, Particles, PeriodicBox, ToWall, Vector};
use hydrodynamics::ContactSprings;
use lubrication::{Contact, PairKind};
use std::rc::Rc;

/// A contact as seen by one of its two particles. The other, on this rank or another, sees the same with axis and force
/// reversed, bit for bit.
#[derive(Debug, Clone, Copy)]
pub struct Touching {
    /// Row of the particle, and row of the other among local particles and ghosts; for a wall, the row after the last.
    pub rows: [usize; 2],
    /// Id of the other particle, or the id that stands for a wall.
    pub other: u64,
    /// Vector from the particle's centre to the other's image, or to the nearest point of a wall.
    pub separation: Vector,
    /// Unit vector along `separation`.
    pub axis: Vector,
    /// Point of contact.
    pub place: Vector,
    /// The surfaces in contact, and the distances of both centres from the point of contact (0 for a wall).
    pub between: PairKind,
    pub arms: [f64; 2],
    pub overlap: f64,
    /// State of the contact, with its forces rotated into the present tangential plane.
    pub memory: Memory,
}

/// All contacts, by rows and then by the ids of the others.
pub struct AllTouching {
    /// Particles and ghosts.
    pub present: Rc<LocalParticles>,
    /// Contacts of each particle.
    pub list: RowLists<Touching>,
}

impl AllTouching {
    /// The contacts among near particles.
    pub fn of(law: &Contact, particles: &Particles, cell: &PeriodicBox, near: NearParticles) -> Self {
        let NearParticles { present, neighbours } = near;
        let search = ContactSearch {
            law: *law,
            cell,
            ids: present.ids(),
            positions: present.positions(),
            radii: present.radii(),
            neighbours: &neighbours,
            known: particles.columns.iter().find(|column| column.name == CONTACTS),
        };
        let list = RowLists::of_rows(particles.len(), |row, list| search.append(row, list));
        Self { present, list }
    }

    /// Lists of values relative to the flow for all local particles and ghosts, from those of this rank's particles,
    /// and zero for walls, which move with the flow. An empty list stands for zeros. Collective.
    pub fn extended<const N: usize>(&self, lists: [&[Vector]; N]) -> [Vec<Vector>; N] {
        let count = self.present.ids().len() + 1;
        let mut extended = lists.map(|_| Vec::with_capacity(count));
        let mut loops = FusedLoops::default();
        extended.iter_mut().zip(lists).for_each(|(all, own)| loops.copied(all, own));
        loops.run();
        for all in &mut extended {
            all.resize(self.present.owned(), Vector::ZERO);
            self.present.halo().extend(all);
            all.push(Vector::ZERO);
        }
        extended
    }
}

/// Search for the contacts of particles among their neighbours and the walls.
struct ContactSearch<'a> {
    law: Contact,
    cell: &'a PeriodicBox,
    /// Ids, positions and radii of particles and ghosts.
    ids: &'a [u64],
    positions: &'a [Vector],
    radii: &'a [f64],
    neighbours: &'a Neighbours,
    /// State of the contacts at the start of the substep, if there were any.
    known: Option<&'a Column>,
}

impl ContactSearch<'_> {
    /// Appends the contacts of a row, by the ids of the others.
    fn append(&self, row: usize, list: &mut Vec<Touching>) {
        let first = list.len();
        list.extend(self.neighbours.of(row).iter().filter_map(|neighbour| self.with_sphere(row, neighbour)));
        list.extend(self.cell.to_walls(self.positions[row]).filter_map(|to| self.with_wall(row, &to)));
        list[first..].sort_unstable_by_key(|touching| touching.other);
    }

    fn with_sphere(&self, row: usize, neighbour: Neighbour) -> Option<Touching> {
        let other = neighbour.row as usize;
        let mut separation = self.positions[other] - self.positions[row];
        if neighbour.steps != [0; 3] {
            separation += self.cell.lattice(neighbour.steps.map(i32::from));
        }
        let (distance, pair) = (separation.length(), [self.radii[row], self.radii[other]]);
        let overlap = self.law.overlap(distance, pair);
        if overlap <= 0.0 {
            return None;
        }
        let (axis, sum) = (separation / distance, pair[0] + pair[1]);
        Some(Touching {
            rows: [row, other],
            other: self.ids[other],
            separation,
            axis,
            place: self.positions[row] + separation * (pair[0] / sum),
            between: PairKind::Spheres(pair),
            arms: pair.map(|a| distance * a / sum),
            overlap,
            memory: self.memory(row, self.ids[other], axis),
        })
    }

    fn with_wall(&self, row: usize, to: &ToWall) -> Option<Touching> {
        let between = PairKind::Wall(self.radii[row]);
        let (overlap, other) = (self.law.overlap(to.distance, between), ContactSprings::wall(to.wall));
        if overlap <= 0.0 {
            return None;
        }
        Some(Touching {
            rows: [row, self.positions.len()],
            other,
            separation: to.axis * to.distance,
            axis: to.axis,
            place: self.positions[row] + to.axis * to.distance,
            between,
            arms: [to.distance, 0.0],
            overlap,
            memory: self.memory(row, other, to.axis),
        })
    }

    /// State of the contact of a row with another particle or a wall, given the present axis.
    fn memory(&self, row: usize, other: u64, axis: Vector) -> Memory {
        turned(self.known.and_then(|column| recall(column, row, other)).unwrap_or_default(), axis)
    }
}

impl Touching {
    /// Slip velocity: velocity of the other's surface relative to the particle's, for velocities and angular velocities
    /// relative to a flow whose strain separates the centres with the velocity `strained`.
    pub fn slip(&self, velocities: &[Vector], angular: &[Vector], strained: Vector) -> Vector {
        let [own, other] = self.rows;
        let turning = self.arms[0] * angular[own] + self.arms[1] * angular[other];
        let relative = (velocities[other] - velocities[own]) + strained - turning.cross(self.axis);
        across(relative, self.axis)
    }

    /// Rolling velocity.
    pub fn rolling(&self, angular: &[Vector]) -> Vector {
        let [own, other] = self.rows;
        self.between.harmonic_radius() * (angular[other] - angular[own]).cross(self.axis)
    }

    /// Rate at which the centres separate.
    pub fn separation_rate(&self, velocities: &[Vector]) -> f64 {
        let [own, other] = self.rows;
        self.axis.dot(velocities[other] - velocities[own])
    }

    /// Force and torque on the particle from a normal force and the state of the contact.
    pub fn load(&self, normal: f64, memory: &Memory) -> [Vector; 2] {
        let force = memory.force - normal * self.axis;
        let torque = self.axis.cross(self.arms[0] * memory.force + self.between.harmonic_radius() * memory.rolling);
        [force, torque]
    }
}

/// The component of a vector perpendicular to a unit vector.
pub fn across(vector: Vector, axis: Vector) -> Vector {
    vector - axis.dot(vector) * axis
}

/// The state with forces projected on the plane perpendicular to an axis, magnitudes kept.
fn turned(memory: Memory, axis: Vector) -> Memory {
    let turn = |force: Vector| {
        let flat = across(force, axis);
        if flat == Vector::ZERO { flat } else { flat * (force.length() / flat.length()) }
    };
    Memory { force: turn(memory.force), rolling: turn(memory.rolling), ..memory }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::{Tensor, Traceless};

    /// A contact of two spheres as seen by each: rows 0 and 1, and the reverse.
    fn both() -> [Touching; 2] {
        let separation = Vector::new(1.2, -2.0, 0.7);
        let (distance, radii) = (separation.length(), [1.0, 1.5]);
        let axis = separation / distance;
        let force = across(Vector::new(0.3, 0.8, -0.5), axis);
        let rolling = across(Vector::new(-0.2, 0.1, 0.4), axis);
        let memory = Memory { force, rolling, ..Memory::default() };
        let arms = radii.map(|a| distance * a / 2.5);
        let between = PairKind::Spheres(radii);
        let one = Touching {
            rows: [0, 1],
            other: 1,
            separation,
            axis,
            place: Vector::ZERO,
            between,
            arms,
            overlap: 0.01,
            memory,
        };
        let reversed = Memory { force: -force, ..memory };
        let swap = |[a, b]: [f64; 2]| [b, a];
        let (between, arms) = (PairKind::Spheres(swap(radii)), swap(arms));
        let other = Touching {
            rows: [1, 0],
            other: 0,
            separation: -separation,
            axis: -axis,
            between,
            arms,
            memory: reversed,
            ..one
        };
        [one, other]
    }

    const VELOCITIES: [Vector; 2] = [Vector::new(0.4, -0.1, 0.9), Vector::new(-0.3, 0.6, 0.2)];
    const ANGULAR: [Vector; 2] = [Vector::new(0.5, 0.2, -0.7), Vector::new(0.1, -0.9, 0.3)];

    /// Power balance: the power of contact loads on the spheres equals the power released by the springs, minus the
    /// losses by slip and rolling, plus the power of the flow's strain on the contact stress.
    #[test]
    fn the_powers_of_a_contact_balance() {
        let strain = Traceless([0.3, 0.5, -0.2, 0.1, 0.4]).tensor();
        let normal = 3.0;
        let (mut of_loads, mut moment) = (0.0, Tensor::ZERO);
        for contact in both() {
            let [force, torque] = contact.load(normal, &contact.memory);
            let row = contact.rows[0];
            of_loads += force.dot(VELOCITIES[row]) + torque.dot(ANGULAR[row]);
            let arm = contact.arms[0] * contact.axis;
            moment += Tensor::from_cols(arm * force.x, arm * force.y, arm * force.z);
        }
        let [one, _] = both();
        let strained = strain * one.separation;
        let released = normal * (one.separation_rate(&VELOCITIES) + one.axis.dot(strained));
        let slipped = one.memory.force.dot(one.slip(&VELOCITIES, &ANGULAR, strained));
        let rolled = one.memory.rolling.dot(one.rolling(&ANGULAR));
        let strained: f64 = (0..3).map(|k| moment.col(k).dot(strain.col(k))).sum();
        let balance = released - slipped - rolled + strained;
        assert!((of_loads - balance).abs() < 1e-14 && of_loads.abs() > 0.1, "{of_loads} is not {balance}");
    }

    #[test]
    fn both_spheres_see_the_same_to_the_last_bit() {
        let [one, other] = both();
        let strained = Vector::new(0.1, 0.7, -0.3);
        assert_eq!(one.slip(&VELOCITIES, &ANGULAR, strained), -other.slip(&VELOCITIES, &ANGULAR, -strained));
        assert_eq!(one.rolling(&ANGULAR), other.rolling(&ANGULAR));
        assert!(one.separation_rate(&VELOCITIES).to_bits() == other.separation_rate(&VELOCITIES).to_bits());
        assert_eq!(one.load(2.0, &one.memory)[0], -other.load(2.0, &other.memory)[0]);
    }

    /// A pair in rigid-body rotation neither slips nor rolls.
    #[test]
    fn a_pair_that_turns_like_one_body_feels_no_friction() {
        let [one, _] = both();
        let turning = Vector::new(0.3, -0.8, 0.5);
        let velocities = [Vector::ZERO, turning.cross(one.separation)];
        assert!(one.slip(&velocities, &[turning; 2], Vector::ZERO).length() < 1e-14);
        assert_eq!(one.rolling(&[turning; 2]), Vector::ZERO);
    }

    #[test]
    fn forces_turn_with_the_pair_and_keep_their_magnitude() {
        let [one, _] = both();
        let tilted = (one.axis + 0.1 * one.memory.force).normalize();
        let memory = turned(one.memory, tilted);
        assert!(memory.force.dot(tilted).abs() < 1e-15);
        assert!((memory.force.length() - one.memory.force.length()).abs() < 1e-15);
    }
}
