//! Contacts between rough spheres: their springs in the solve, what slides, and what is remembered.

mod forces;
mod history;
mod measured;
mod settling;
mod touching;

use crate::moving_box::MovingBox;
use domain::{Particles, Partition, PeriodicBox, Traceless, Vector};
use fcm::{Loads, Motion};
pub use forces::{FORCE_NUMBERS, contact_force, of as force_numbers};
pub use history::{CONTACT_NUMBERS, keep, most_contacts};
use history::{FOUND, Memory, note};
use hydrodynamics::ContactSprings;
use hydrodynamics::StrainRate;
use lubrication::{Contact, Surfaces};
pub use measured::Measured;
pub use settling::{SETTLING_NUMBERS, Settling};
use touching::{AllTouching, Touching, across};

/// The contacts of a suspension.
pub struct Contacts {
    law: Contact,
    /// Distance of the centres up to which any two spheres touch.
    reach: f64,
    /// Contacts that a particle remembers at most.
    slots: usize,
    /// How the stiffness adapts, if it does.
    settling: Option<Settling>,
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
/// normal force is `F_n(d*) - t k (w - w*)`, linear in what is solved for. Across, with `f` the force at the start of the
/// substep `h`, `v` the slip and `v*` that of the solution before, it is
///
/// ```text
/// f + h k_t v                    of a contact that stuck at the start
/// f + s/2 h k_t (v - v*)         of one that slid
/// ```
///
/// where `s` is the share of the spring's force that friction allowed at the start. At the end the force is that of the spring,
/// `f + h k_t v`, cut to what friction allows under the normal force then. So a contact that slides steadily has the force
/// that it had, whichever way it turns, and is known within some substeps where that changes: the derivative of the cut force
/// is `s h k_t` across the slip and nothing along it, and half of that brings either about equally fast.
pub struct Acting {
    law: Contact,
    slots: usize,
    ahead: Ahead,
    touching: AllTouching,
    /// Of each that touches.
    expected: Vec<Expected>,
    flow: Flow,
}

/// The flow that velocities are relative to.
#[derive(Debug, Clone, Copy)]
pub struct Flow {
    /// The rate of strain, and the angular velocity at `z = 0`.
    strain_rate: StrainRate,
    turning: Vector,
    /// The rate of strain expected besides.
    besides: Traceless,
}

impl Flow {
    /// That of a box, and the rate of strain that is expected besides.
    pub fn of(moving: &MovingBox, besides: Traceless) -> Self {
        Self { strain_rate: moving.strain_rate(), turning: moving.angular_velocity_at(Vector::ZERO), besides }
    }

    /// How fast its strain where the surfaces touch moves the centres apart: so spheres that the flow turns each in its own way
    /// slip as they do.
    fn strained(&self, contact: &Touching) -> Vector {
        strained(contact, self.strain_rate.at(contact.place.z))
    }

    /// How fast a sphere that turns as the fluid does rolls over a wall, which does not turn.
    fn rolled(&self, contact: &Touching) -> Vector {
        let Surfaces::Wall(_) = contact.between else { return Vector::ZERO };
        let turning = self.turning + self.strain_rate.turning((contact.place - contact.separation).z);
        -contact.between.harmonic_radius() * turning.cross(contact.axis)
    }
}

/// What is expected of a contact.
#[derive(Debug, Clone, Copy)]
struct Expected {
    /// How fast the centres part.
    parting: f64,
    /// The slip and the velocity of rolling, as in the solution before.
    slip: Vector,
    rolling: Vector,
}

/// Of the derivative of a force that is cut, what goes with the solve.
const CUT: f64 = 0.5;

/// What the contact of a row with the particle of an id remembers at the end.
type End = (usize, u64, Memory);

impl Contacts {
    /// Contacts of a law, between so many spheres whose radii are between two.
    pub fn new(law: Contact, (radii, count): ([f64; 2], usize)) -> Self {
        Self { law, reach: law.reach([radii[1]; 2]), slots: most_contacts(radii, count), settling: None }
    }

    /// The same with a stiffness that adapts, if it does.
    #[must_use]
    pub fn settling(mut self, settling: Option<Settling>) -> Self {
        self.settle_at(settling);
        self
    }

    /// How the stiffness adapts, if it does.
    pub fn how_it_settles(&self) -> Option<Settling> {
        self.settling
    }

    /// Goes on with a stiffness that adapts.
    pub fn settle_at(&mut self, settling: Option<Settling>) {
        self.settling = settling;
        self.law.stiffness = settling.map_or(self.law.stiffness, |settling| settling.stiffness());
    }

    /// Has the stiffness stay what it is.
    pub fn end_settling(&mut self) {
        self.settling.iter_mut().for_each(Settling::end);
    }

    /// The stiffness.
    pub fn stiffness(&self) -> f64 {
        self.law.stiffness
    }

    /// Adapts the stiffness, while it does, after the flow has gone on by a strain. Collective.
    pub fn adapt(&mut self, particles: &Particles, place: (&PeriodicBox, &Partition), strain: f64) {
        let Some(mut settling) = self.settling.filter(|settling| !settling.is_over()) else { return };
        let touching = AllTouching::find(&self.law, particles, place, self.reach);
        let mut largest = [measured::largest_overlap(&self.law, &touching)];
        place.1.comm().max(&mut largest);
        settling.adapt(largest[0], strain);
        self.settle_at(Some(settling));
    }

    /// The contacts of particles whose velocities relative to a flow are expected to be given ones and those that it has
    /// besides, after the motions of the solution before. Collective.
    pub fn acting(
        &self,
        particles: &Particles,
        place: (&PeriodicBox, &Partition),
        (ahead, expected, flow): (Ahead, &[Vector], Flow),
        before: &Motion,
    ) -> Acting {
        let touching = AllTouching::find(&self.law, particles, place, self.reach);
        let parting = touching.present(expected);
        let velocities = touching.present(&before.velocities);
        let angular = touching.present(&before.angular_velocities);
        let of_one = |contact: &Touching| Expected {
            parting: contact.parting(&parting) + contact.axis.dot(strained(contact, flow.besides)),
            slip: contact.slip(&velocities, &angular, flow.strained(contact)),
            rolling: contact.rolling(&angular) + flow.rolled(contact),
        };
        let expected = touching.list.iter().map(of_one).collect();
        Acting { law: self.law, slots: self.slots, ahead, touching, expected, flow }
    }

    /// The contacts of this rank's particles with others of higher ids, in rows of numbers that [`contact_force`] reads.
    /// Collective.
    pub fn forces(&self, particles: &Particles, place: (&PeriodicBox, &Partition)) -> Vec<[f64; FORCE_NUMBERS]> {
        let touching = AllTouching::find(&self.law, particles, place, self.reach);
        let own = |contact: &&Touching| particles.ids[contact.rows[0]] < contact.other;
        touching.list.iter().filter(own).map(|contact| forces::numbers(&self.law, contact, particles)).collect()
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
            let [along, slip, roll] = self.resistances(contact);
            let normal = self.law.force(contact.overlap, contact.between) + along * expected.parting;
            let [slides, rolls] = contact.memory.shares.map(|share| if share < 1.0 { 1.0 } else { 0.0 });
            let mut memory = contact.memory;
            memory.force += slip * (across(self.flow.strained(contact), contact.axis) - slides * expected.slip);
            memory.rolling += roll * (self.flow.rolled(contact) - rolls * expected.rolling);
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

    /// The `xy` component of the symmetric first moments of this rank's contact forces at the end, after motions relative to the
    /// flow. Collective.
    pub fn shear_moment(&self, motion: &Motion) -> f64 {
        let ends = self.ends(motion);
        let of_one = |(contact, (_, _, memory)): (&Touching, &End)| {
            let [force, _] = contact.load(memory.normal, memory);
            let arm = contact.arms[0] * contact.axis;
            0.5 * (arm.x * force.y + arm.y * force.x)
        };
        self.touching.list.iter().zip(&ends).map(of_one).sum()
    }

    /// What contacts remember at the end, in the order of rows. Collective.
    fn ends(&self, motion: &Motion) -> Vec<End> {
        let velocities = self.touching.present(&motion.velocities);
        let angular = self.touching.present(&motion.angular_velocities);
        let end = |(contact, expected): (&Touching, &Expected)| {
            let stiffness = self.ahead.along * self.law.normal_stiffness(contact.overlap, contact.between);
            let known = self.law.force(contact.overlap, contact.between);
            let normal = (known - stiffness * (contact.parting(&velocities) - expected.parting)).max(0.0);
            let spring = self.ahead.across * self.law.tangential_stiffness(contact.overlap, contact.between);
            let slip = contact.slip(&velocities, &angular, self.flow.strained(contact));
            let force = contact.memory.force + spring * slip;
            let rolled = contact.rolling(&angular) + self.flow.rolled(contact);
            let rolling = contact.memory.rolling + spring * rolled;
            let most = [self.law.cone(normal), self.law.rolling_friction * normal];
            let shares = [share(force, most[0]), share(rolling, most[1])];
            let memory = Memory { force: shares[0] * force, rolling: shares[1] * rolling, normal, shares };
            (contact.rows[0], contact.other, memory)
        };
        self.touching.list.iter().zip(&self.expected).map(end).collect()
    }

    /// Along the line of centres, to slip and to rolling.
    fn resistances(&self, contact: &Touching) -> [f64; 3] {
        let along = self.ahead.along * self.law.normal_stiffness(contact.overlap, contact.between);
        let spring = self.ahead.across * self.law.tangential_stiffness(contact.overlap, contact.between);
        let of_share = |share: f64| if share < 1.0 { CUT * share * spring } else { spring };
        let [slip, rolling] = contact.memory.shares.map(of_share);
        let on = |friction: f64, resistance: f64| if friction > 0.0 { resistance } else { 0.0 };
        [along, on(self.law.friction, slip), on(self.law.rolling_friction, rolling)]
    }
}

/// How fast a flow's strain moves the centres apart.
fn strained(contact: &Touching, strain_rate: Traceless) -> Vector {
    strain_rate.tensor() * contact.separation
}

/// By what a force is to be multiplied not to be larger than some.
fn share(force: Vector, most: f64) -> f64 {
    let length = force.length();
    if length > most { most / length } else { 1.0 }
}
