//! History of the contacts, stored in columns of the particles.

use domain::{Column, Particles, Vector};

/// The column of the current contacts, and the column of the contacts found in the evaluation in progress, which does
/// not exist between substeps.
pub const CONTACTS: &str = "contacts";
pub const FOUND: &str = "contacts found";

/// State of a contact as seen by one of its two particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Memory {
    /// Tangential force on the particle.
    pub force: Vector,
    /// Rolling resistance as a force, which exerts the torque `a n x force` on the particle.
    pub rolling: Vector,
    /// Normal force.
    pub normal: f64,
    /// The tangential and rolling forces over the forces of their springs without sliding or rolling: 1 if the contact
    /// sticks.
    pub shares: [f64; 2],
}

impl Default for Memory {
    fn default() -> Self {
        Self { force: Vector::ZERO, rolling: Vector::ZERO, normal: 0.0, shares: [1.0; 2] }
    }
}

/// Numbers stored per contact: the id of the other particle plus 1 (0 for an empty slot), and the state.
pub const CONTACT_NUMBERS: usize = 10;

/// Upper bound of the number of contacts of a particle. Spheres with the largest ratio of radii touch it all around:
/// the bound follows from the fraction of its surface, widened by the radius of the others, that each covers. It never
/// exceeds the number of other spheres.
pub fn most_contacts(radii: [f64; 2], count: usize) -> usize {
    let ratio = radii[1] / radii[0];
    ((0.9 * 4.0 * (1.0 + ratio).powi(2)).ceil() as usize).min(count.saturating_sub(1)).max(1)
}

/// Message for a particle with more contacts than slots.
pub fn too_many(id: u64, slots: usize) -> String {
    format!("particle {id} has more than {slots} contacts")
}

/// Stored state of the contact of a row with the particle `id`.
pub fn recall(column: &Column, row: usize, id: u64) -> Option<Memory> {
    let of_row = &column.values[row * column.width..][..column.width];
    let mut slots = of_row.as_chunks::<CONTACT_NUMBERS>().0.iter().take_while(|slot| slot[0] != 0.0);
    slots.find(|slot| slot[0] as u64 == id + 1).map(|slot| Memory {
        force: Vector::from_slice(&slot[1..4]),
        rolling: Vector::from_slice(&slot[4..7]),
        normal: slot[7],
        shares: [slot[8], slot[9]],
    })
}

/// Fills slots of a row that are empty, at least as many as there are contacts.
pub fn note<'a>(of_row: &mut [f64], contacts: impl Iterator<Item = (u64, &'a Memory)>) {
    for (slot, (id, memory)) in of_row.as_chunks_mut::<CONTACT_NUMBERS>().0.iter_mut().zip(contacts) {
        slot[0] = (id + 1) as f64;
        slot[1..4].copy_from_slice(&memory.force.to_array());
        slot[4..7].copy_from_slice(&memory.rolling.to_array());
        slot[7] = memory.normal;
        slot[8..].copy_from_slice(&memory.shares);
    }
}

/// Replaces the current contacts by those found last.
pub fn keep(particles: &mut Particles) {
    let Some(found) = particles.columns.iter().position(|column| column.name == FOUND) else { return };
    let found = particles.columns.remove(found);
    *particles.column(CONTACTS, found.width) = Column { name: CONTACTS.to_owned(), ..found };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_noted_is_recalled() {
        let mut particles = Particles::default();
        for id in 0..3 {
            particles.push(id, Vector::ZERO, 1.0, 0);
        }
        let memory = Memory { force: Vector::X, rolling: Vector::Y, normal: 2.0, shares: [0.5, 1.0] };
        let width = 2 * CONTACT_NUMBERS;
        let of_row = &mut particles.column(FOUND, width).values[width..2 * width];
        note(of_row, [(0, &memory), (2, &Memory::default())].into_iter());
        keep(&mut particles);
        let column = particles.column(CONTACTS, 2 * CONTACT_NUMBERS).clone();
        assert_eq!(recall(&column, 1, 0), Some(memory));
        assert_eq!((recall(&column, 1, 2), recall(&column, 1, 1)), (Some(Memory::default()), None));
        assert_eq!((recall(&column, 0, 0), particles.columns.len()), (None, 1));
    }

    #[test]
    fn spheres_of_one_size_have_up_to_fifteen_contacts() {
        assert_eq!((most_contacts([1.0, 1.0], 100), most_contacts([1.0, 1.4], 100)), (15, 21));
        assert_eq!((most_contacts([1.0, 1e3], 100), most_contacts([1.0, 1.0], 1)), (99, 1));
    }
}
