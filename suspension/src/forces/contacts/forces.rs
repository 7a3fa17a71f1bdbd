//! Forces of individual contacts.

use super::touching::Touching;
use domain::Vector;
use lubrication::Contact;
use simulation::{ContactForce, ContactState};

/// Numbers per contact sent to the first rank: both ids, the centre of the first sphere, the separation, the normal and
/// the tangential force, and the state.
pub const FORCE_NUMBERS: usize = 13;

/// The numbers of a contact as seen by its particle, of an id and at a position.
pub(super) fn numbers(law: &Contact, contact: &Touching, id: u64, position: Vector) -> [f64; FORCE_NUMBERS] {
    let normal = law.force(contact.overlap, contact.between);
    let state = match contact.memory.shares[0] {
        _ if law.coulomb_limit(normal) <= 0.0 => ContactState::Frictionless,
        share if share < 1.0 => ContactState::Sliding,
        _ => ContactState::Sticking,
    };
    of(&ContactForce {
        ids: [id, contact.other],
        position,
        separation: contact.separation,
        normal,
        tangential: contact.memory.force,
        state,
    })
}

/// Packs a contact into numbers.
pub fn of(force: &ContactForce) -> [f64; FORCE_NUMBERS] {
    let mut numbers = [0.0; FORCE_NUMBERS];
    numbers[..2].copy_from_slice(&force.ids.map(|id| id as f64));
    numbers[2..5].copy_from_slice(&force.position.to_array());
    numbers[5..8].copy_from_slice(&force.separation.to_array());
    numbers[8] = force.normal;
    numbers[9..12].copy_from_slice(&force.tangential.to_array());
    numbers[12] = f64::from(force.state.number());
    numbers
}

/// Unpacks a contact from its numbers.
pub fn contact_force(numbers: &[f64; FORCE_NUMBERS]) -> ContactForce {
    let [place, separation, tangential] = [2, 5, 9].map(|first| Vector::from_slice(&numbers[first..]));
    ContactForce {
        ids: [numbers[0] as u64, numbers[1] as u64],
        position: place,
        separation,
        normal: numbers[8],
        tangential,
        state: ContactState::ALL[numbers[12] as usize],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_is_the_same_in_numbers() {
        let force = ContactForce {
            ids: [3, (1 << 52) + 1],
            position: Vector::new(0.1, 0.2, 0.3),
            separation: Vector::new(1.0, 2.0, -3.0),
            normal: 0.7,
            tangential: Vector::Y / 3.0,
            state: ContactState::Sliding,
        };
        assert_eq!(contact_force(&of(&force)), force);
    }
}
