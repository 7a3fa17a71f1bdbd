//! The contacts of the particles that a rank owns.

use super::history::{CONTACTS, Memory, recall};
use domain::{Halo, Neighbours, Particles, Partition, PeriodicBox, Vector};
use lubrication::Contact;

/// A contact as one of its two particles sees it. The other, on this rank or another, sees the same with its axis and force
/// reversed, to the last bit.
#[derive(Debug, Clone, Copy)]
pub struct Touching {
    /// Rows of the particle and, among local particles and ghosts, of the other.
    pub rows: [usize; 2],
    /// The id of the other.
    pub other: u64,
    /// From the particle's centre to the other's image.
    pub separation: Vector,
    /// The unit vector along it.
    pub axis: Vector,
    /// Both radii, and the distances of the centres from where the surfaces touch.
    pub radii: [f64; 2],
    pub arms: [f64; 2],
    pub overlap: f64,
    /// What it remembers, with forces turned into the present plane across the axis.
    pub memory: Memory,
}

/// All of them, row by row and in the order of the others' ids.
pub struct AllTouching {
    pub halo: Halo,
    pub list: Vec<Touching>,
}

impl AllTouching {
    /// Finds them. Collective.
    pub fn find(
        law: &Contact,
        particles: &Particles,
        (cell, partition): (&PeriodicBox, &Partition),
        reach: f64,
    ) -> Self {
        let halo = Halo::plan(partition, cell, &particles.positions, [reach; 2]);
        let (mut positions, mut radii, mut ids) =
            (particles.positions.clone(), particles.radii.clone(), particles.ids.clone());
        halo.extend(&mut positions);
        halo.extend(&mut radii);
        halo.extend(&mut ids);
        let neighbours = Neighbours::find(cell, &positions, particles.len(), reach);
        let known = particles.columns.iter().find(|column| column.name == CONTACTS);
        let mut list = Vec::new();
        for row in 0..particles.len() {
            let first = list.len();
            for neighbour in neighbours.of(row) {
                let other = neighbour.row as usize;
                let mut separation = positions[other] - positions[row];
                if neighbour.steps != [0; 3] {
                    separation += cell.lattice(neighbour.steps.map(i32::from));
                }
                let (distance, pair) = (separation.length(), [radii[row], radii[other]]);
                let overlap = law.overlap(distance, pair);
                if overlap <= 0.0 {
                    continue;
                }
                let (axis, sum) = (separation / distance, pair[0] + pair[1]);
                let memory = known.and_then(|column| recall(column, row, ids[other])).unwrap_or_default();
                list.push(Touching {
                    rows: [row, other],
                    other: ids[other],
                    separation,
                    axis,
                    radii: pair,
                    arms: pair.map(|a| distance * a / sum),
                    overlap,
                    memory: turned(memory, axis),
                });
            }
            list[first..].sort_unstable_by_key(|touching| touching.other);
        }
        Self { halo, list }
    }

    /// Values of all particles present, from those of this rank's. Collective.
    pub fn present(&self, values: &[Vector]) -> Vec<Vector> {
        let mut present = values.to_vec();
        present.resize(self.halo.owned(), Vector::ZERO);
        self.halo.extend(&mut present);
        present
    }
}

impl Touching {
    /// How fast the surface of the other moves past the particle's, for velocities and angular velocities relative to a flow
    /// whose rate of strain moves the centres apart at `strained`.
    pub fn slip(&self, velocities: &[Vector], angular: &[Vector], strained: Vector) -> Vector {
        let [own, other] = self.rows;
        let turning = self.arms[0] * angular[own] + self.arms[1] * angular[other];
        let relative = (velocities[other] - velocities[own]) + strained - turning.cross(self.axis);
        across(relative, self.axis)
    }

    /// The velocity of rolling over each other.
    pub fn rolling(&self, angular: &[Vector]) -> Vector {
        let [own, other] = self.rows;
        self.harmonic_radius() * (angular[other] - angular[own]).cross(self.axis)
    }

    /// How fast the centres move apart.
    pub fn parting(&self, velocities: &[Vector]) -> f64 {
        let [own, other] = self.rows;
        self.axis.dot(velocities[other] - velocities[own])
    }

    /// The force and the torque on the particle by a normal force and what the contact remembers.
    pub fn load(&self, normal: f64, memory: &Memory) -> [Vector; 2] {
        let force = memory.force - normal * self.axis;
        let torque = self.axis.cross(self.arms[0] * memory.force + self.harmonic_radius() * memory.rolling);
        [force, torque]
    }

    fn harmonic_radius(&self) -> f64 {
        2.0 * self.radii[0] * self.radii[1] / (self.radii[0] + self.radii[1])
    }
}

/// The part of a vector across a unit vector.
pub fn across(vector: Vector, axis: Vector) -> Vector {
    vector - axis.dot(vector) * axis
}

/// What is remembered, with forces of the same magnitude in the plane across an axis.
fn turned(memory: Memory, axis: Vector) -> Memory {
    let turn = |force: Vector| {
        let flat = across(force, axis);
        if flat == Vector::ZERO { flat } else { flat * (force.length() / flat.length()) }
    };
    Memory { force: turn(memory.force), rolling: turn(memory.rolling), ..memory }
}
