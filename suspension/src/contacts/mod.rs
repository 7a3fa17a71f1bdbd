//! Contacts between rough spheres: their springs in the solve, what slides, and what is remembered.

mod history;
mod measured;
mod touching;

use crate::hydrodynamics::ContactSprings;
use domain::{Particles, Partition, PeriodicBox, Traceless, Vector};
use fcm::{Loads, Motion};
pub use history::{CONTACT_NUMBERS, keep, most_contacts};
use history::{FOUND, Memory, note};
use lubrication::{Contact, cut};
pub use measured::Measured;
use touching::{AllTouching, Touching, across};

/// The contacts of a suspension.
pub struct Contacts {
    law: Contact,
    /// Distance of the centres up to which any two spheres touch.
    reach: f64,
    /// Contacts that a particle remembers at most.
    slots: usize,
}

/// Times by which forces are to be ahead of what is known: of the places of an evaluation, for springs along the line of
/// centres, and of the start of the substep, for those across.
#[derive(Debug, Clone, Copy)]
pub struct Ahead {
    pub along: f64,
    pub across: f64,
}

/// Contacts at the places of an evaluation, whose forces are to be those at its end.
///
/// With `w` the rate at which the centres part, `w*` that expected and `d*` the overlap at the places that it leads to, the
/// normal force is `F_n(d*) - t k (w - w*)`, linear in what is solved for. A contact that sticks has the force
/// `f + t k_t v` across, with `f` that at the start and `v` the slip; one that slid at the start goes on with what friction
/// allows under the normal force at the start, in the direction of its force.
pub struct Acting {
    law: Contact,
    slots: usize,
    ahead: Ahead,
    touching: AllTouching,
    /// Of each that touches, how fast the centres part as expected.
    expected: Vec<f64>,
    strain_rate: Traceless,
}

/// What the contact of a row with the particle of an id remembers at the end.
type End = (usize, u64, Memory);

impl Contacts {
    /// Contacts of a law, between spheres whose radii are between two.
    pub fn new(law: Contact, radii: [f64; 2]) -> Self {
        Self { law, reach: law.reach([radii[1]; 2]), slots: most_contacts(radii) }
    }

    /// The contacts of particles whose velocities relative to a flow of some rate of strain are expected to be given ones.
    /// Collective.
    pub fn acting(
        &self,
        particles: &Particles,
        place: (&PeriodicBox, &Partition),
        (ahead, expected, strain_rate): (Ahead, &[Vector], Traceless),
    ) -> Acting {
        let touching = AllTouching::find(&self.law, particles, place, self.reach);
        let expected = touching.present(expected);
        let expected = touching.list.iter().map(|contact| contact.parting(&expected)).collect();
        Acting { law: self.law, slots: self.slots, ahead, touching, expected, strain_rate }
    }

    /// What contacts amount to. Collective.
    pub fn measured(&self, particles: &Particles, place: (&PeriodicBox, &Partition)) -> Measured {
        Measured::of(&self.law, &AllTouching::find(&self.law, particles, place, self.reach), particles)
    }
}

impl Acting {
    /// Adds the known part of the contacts' forces and torques to the loads on the particles that this rank owns.
    pub fn add_to(&self, loads: &mut Loads) {
        let owned = self.touching.halo.owned();
        loads.forces.resize(owned, Vector::ZERO);
        loads.torques.resize(owned, Vector::ZERO);
        for (contact, expected) in self.touching.list.iter().zip(&self.expected) {
            let [along, slip, _] = self.resistances(contact);
            let normal = self.law.force(contact.overlap, contact.radii) + along * expected;
            let memory = if contact.memory.slides {
                self.slid(contact.memory, contact.memory.normal)
            } else {
                let strained = slip * across(self.strained(contact), contact.axis);
                Memory { force: contact.memory.force + strained, ..contact.memory }
            };
            let [force, torque] = contact.load(normal, &memory);
            loads.forces[contact.rows[0]] += force;
            loads.torques[contact.rows[0]] += torque;
        }
    }

    /// What contacts resist to motions, particle by particle.
    pub fn springs(&self) -> Vec<Vec<ContactSprings>> {
        let mut springs = vec![Vec::new(); self.touching.halo.owned()];
        for contact in &self.touching.list {
            let [normal, tangential, rolling] = self.resistances(contact);
            springs[contact.rows[0]].push(ContactSprings { other: contact.other, normal, tangential, rolling });
        }
        springs
    }

    /// Notes what contacts remember at the end, after motions relative to the flow, until [`keep`] makes it that of now.
    /// Refuses more contacts of a particle than there can be. Collective.
    pub fn note(&self, particles: &mut Particles, motion: &Motion) -> Result<(), String> {
        let ends = self.ends(motion);
        let ids = particles.ids.clone();
        let column = particles.column(FOUND, CONTACT_NUMBERS * self.slots);
        let mut rest = &ends[..];
        for (row, id) in ids.iter().enumerate() {
            let (own, others) = rest.split_at(rest.partition_point(|(other, ..)| *other <= row));
            if !note(column, row, own.iter().map(|&(_, id, memory)| (id, memory))) {
                return Err(format!("particle {id} has more than {} contacts", self.slots));
            }
            rest = others;
        }
        Ok(())
    }

    /// What contacts remember at the end, in the order of rows. Collective.
    fn ends(&self, motion: &Motion) -> Vec<End> {
        let velocities = self.touching.present(&motion.velocities);
        let angular = self.touching.present(&motion.angular_velocities);
        let end = |(contact, expected): (&Touching, &f64)| {
            let stiffness = self.ahead.along * self.law.normal_stiffness(contact.overlap, contact.radii);
            let known = self.law.force(contact.overlap, contact.radii);
            let normal = (known - stiffness * (contact.parting(&velocities) - expected)).max(0.0);
            let spring = self.ahead.across * self.law.tangential_stiffness(contact.overlap, contact.radii);
            let slip = contact.slip(&velocities, &angular, self.strained(contact));
            let force = contact.memory.force + spring * slip;
            let rolling = contact.memory.rolling + spring * contact.rolling(&angular);
            // What slid and would go back sticks: it would change its direction for ever.
            let goes_on = !contact.memory.slides || slip.dot(contact.memory.force) >= 0.0;
            let slides = goes_on && force.length() > self.law.cone(normal);
            (contact.rows[0], contact.other, Memory { slides, ..self.slid(Memory { force, rolling, ..contact.memory }, normal) })
        };
        self.touching.list.iter().zip(&self.expected).map(end).collect()
    }

    /// Along the line of centres, to slip and to rolling.
    fn resistances(&self, contact: &Touching) -> [f64; 3] {
        let along = self.ahead.along * self.law.normal_stiffness(contact.overlap, contact.radii);
        let across = self.ahead.across * self.law.tangential_stiffness(contact.overlap, contact.radii);
        let sticks = !contact.memory.slides && self.law.friction > 0.0;
        let [slip, rolling] = [sticks, sticks && self.law.rolling_friction > 0.0].map(|s| if s { across } else { 0.0 });
        [along, slip, rolling]
    }

    /// What friction allows under a normal force.
    fn slid(&self, memory: Memory, normal: f64) -> Memory {
        let force = cut(memory.force, self.law.cone(normal));
        let rolling = cut(memory.rolling, self.law.rolling_friction * normal);
        Memory { force, rolling, normal, ..memory }
    }

    /// How fast the flow's strain moves the centres apart.
    fn strained(&self, contact: &Touching) -> Vector {
        self.strain_rate.tensor() * contact.separation
    }
}
