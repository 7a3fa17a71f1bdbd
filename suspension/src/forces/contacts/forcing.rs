//! The contacts of a solve: loads, implicit resistances, and states at the end of the substep.

use super::history::{CONTACT_NUMBERS, FOUND, Memory, note, too_many};
use super::prediction::{Expected, ForcePrediction, RigidMotions};
use super::touching::{AllTouching, Touching};
use crate::forces::acting::Instant;
use domain::parallel::{RowLists, all_rows, in_blocks, mapped, mapped_mut, of_rows};
use domain::{Column, Particles, Vector};
use fcm::{Loads, Motion};
use hydrodynamics::ContactSprings;
use lubrication::Contact;

/// Rows whose contacts one thread stores at a time.
const STORED: usize = 64;

/// Distance up to which an image of another sphere or a wall is the one in contact, over that of the contact: larger by
/// round-off.
const WITHIN: f64 = 1.0 + 1e-9;

/// Contacts at the positions of an evaluation, with forces predicted for the end of the substep.
pub struct ContactForcing {
    touching: AllTouching,
    prediction: ForcePrediction,
    /// Expected motion of each contact in `touching`.
    expected: Vec<Expected>,
}

impl ContactForcing {
    /// Contacts of an evaluation, from the expected velocities relative to the flow, the expected change of the flow,
    /// and the motions of the previous solution. Collective.
    pub fn new(law: &Contact, touching: AllTouching, at: &Instant) -> Self {
        let (prediction, previous) = (ForcePrediction::of(law, at), at.previous);
        let expected = at.prediction.map_or(&[][..], |prediction| prediction.velocities);
        let [expected, velocities, angular_velocities] =
            &touching.extended([expected, &previous.velocities, &previous.angular_velocities]);
        let previous = RigidMotions { velocities, angular_velocities };
        let expected = mapped(touching.list.items(), |contact| prediction.expected(contact, expected, previous));
        Self { touching, prediction, expected }
    }

    /// Adds the known part of contact forces and torques to the loads on this rank's particles.
    pub fn add_to(&self, loads: &mut Loads) {
        let owned = self.touching.present.owned();
        loads.forces.resize(owned, Vector::ZERO);
        loads.torques.resize(owned, Vector::ZERO);
        let (contacts, expected, prediction) = (&self.touching.list, &self.expected[..], self.prediction);
        let torques = &loads.torques[..];
        loads.torques = mapped_mut(&mut loads.forces, |row, force| {
            let mut sums = [*force, torques[row]];
            for (contact, expected) in contacts.of(row).iter().zip(&expected[contacts.range(row)]) {
                let load = prediction.known_load(contact, expected);
                sums.iter_mut().zip(load).for_each(|(sum, load)| *sum += load);
            }
            *force = sums[0];
            sums[1]
        });
    }

    /// Implicit resistance of the contacts, particle by particle.
    pub fn springs(&self) -> RowLists<ContactSprings> {
        let prediction = self.prediction;
        self.touching.list.mapped(|contact| {
            let [normal, tangential, rolling] = prediction.resistances(contact);
            let within = WITHIN * (contact.arms[0] + contact.arms[1]);
            ContactSprings { other: contact.other, within, normal, tangential, rolling }
        })
    }

    /// State of each contact at the end of the substep, from motions relative to the flow. Collective.
    pub fn ends(&self, motion: &Motion) -> Vec<Memory> {
        let [velocities, angular_velocities] =
            &self.touching.extended([&motion.velocities, &motion.angular_velocities]);
        let motions = RigidMotions { velocities, angular_velocities };
        let (contacts, expected, prediction) = (self.touching.list.items(), &self.expected[..], self.prediction);
        of_rows(contacts.len(), |k| prediction.end(&contacts[k], &expected[k], motions))
    }

    /// Stores the states of the contacts at the end; [`keep`](super::keep) makes them the current ones. Fails if a
    /// particle has more contacts than slots.
    pub fn note(&self, particles: &mut Particles, slots: usize, ends: &[Memory]) -> Result<(), String> {
        let contacts = &self.touching.list;
        let fits = |row: usize| contacts.range(row).len() <= slots;
        if !all_rows(contacts.rows(), fits) {
            let row = (0..contacts.rows()).find(|&row| !fits(row));
            let id = particles.ids[row.expect("a row with more contacts than slots")];
            return Err(too_many(id, slots));
        }
        let width = CONTACT_NUMBERS * slots;
        let (values, _) = in_blocks(width * contacts.rows(), width * STORED, |first, block: &mut [f64]| {
            for (of_row, row) in block.chunks_exact_mut(width).zip(first / width..) {
                let others = contacts.of(row).iter().map(|contact| contact.other);
                note(of_row, others.zip(&ends[contacts.range(row)]));
            }
        });
        particles.remove(|name| name == FOUND);
        particles.columns.push(Column { name: FOUND.to_owned(), width, values: values.into() });
        Ok(())
    }

    /// The `xy` component of the symmetric first moments of this rank's contact forces at the end.
    pub fn shear_moment(&self, ends: &[Memory]) -> f64 {
        let contacts = self.touching.list.items();
        let of_one = |contact: &Touching, memory: &Memory| {
            let [force, _] = contact.load(memory.normal, memory);
            let arm = contact.arms[0] * contact.axis;
            0.5 * (arm.x * force.y + arm.y * force.x)
        };
        // Summed in the order of the contacts on any number of threads.
        of_rows(contacts.len(), |k| of_one(&contacts[k], &ends[k])).iter().sum()
    }
}
