//! Forces of single contacts at the end of a substep, from motions.

use super::flow::{ContactFlow, strained};
use super::history::Memory;
use super::touching::{Touching, across};
use crate::forces::acting::Instant;
use domain::Vector;
use lubrication::Contact;

/// Prediction of contact forces for the end of a substep.
///
/// With `w` the rate at which the centres separate, `w*` its expected value and `d*` the overlap at the positions that
/// `w*` leads to, the normal force is `F_n(d*) - t k (w - w*)`, linear in the unknown velocities. With `f` the
/// tangential force at the start of the substep `h`, `v` the slip velocity and `v*` the one of the previous solution,
/// the tangential force is
///
/// ```text
/// f + h k_t v                    if the contact was sticking at the start
/// f + s/2 h k_t (v - v*)         if it was sliding
/// ```
///
/// where `s` is the force allowed by friction over the force of the spring, at the start. The force at the end is the
/// spring force, `f + h k_t v`, limited by friction under the normal force at the end. A contact that slides steadily
/// thus keeps its force in any direction of sliding, and a change of direction is followed within some substeps: the
/// derivative of the limited force is `s h k_t` across the slip and zero along it, and half of `s h k_t` makes both
/// converge about equally fast.
#[derive(Debug, Clone, Copy)]
pub struct ForcePrediction {
    law: Contact,
    ahead: PredictionTimes,
    flow: ContactFlow,
}

/// Times over which contact forces are predicted: from the positions of the evaluation for springs along the line of
/// centres, and from the start of the substep for tangential springs.
#[derive(Debug, Clone, Copy)]
struct PredictionTimes {
    along: f64,
    across: f64,
}

/// Expected relative motion at a contact.
#[derive(Debug, Clone, Copy)]
pub struct Expected {
    /// Rate at which the centres separate.
    separation_rate: f64,
    /// Slip velocity and rolling velocity, from the previous solution.
    slip: Vector,
    rolling: Vector,
}

/// Motions of particles and ghosts relative to the flow, with those of walls in the end.
#[derive(Clone, Copy)]
pub struct RigidMotions<'a> {
    /// Velocities.
    pub velocities: &'a [Vector],
    /// Angular velocities.
    pub angular_velocities: &'a [Vector],
}

/// Fraction of the derivative of a limited friction force that is treated implicitly.
const CUT: f64 = 0.5;

impl ForcePrediction {
    /// The prediction for an evaluation.
    pub fn of(law: &Contact, at: &Instant) -> Self {
        let ahead = PredictionTimes {
            along: at.prediction.map_or(0.0, |prediction| prediction.time),
            across: at.prediction.map_or(0.0, |_| at.since_last_solution),
        };
        Self { law: *law, ahead, flow: ContactFlow::of(at.flow) }
    }

    /// Expected motion at a contact, from the expected velocities relative to the flow and the motions of the previous
    /// solution.
    pub fn expected(&self, contact: &Touching, velocities: &[Vector], previous: RigidMotions) -> Expected {
        let separation_rate =
            contact.separation_rate(velocities) + contact.axis.dot(strained(contact, self.flow.besides));
        Expected { separation_rate, slip: self.slip(contact, previous), rolling: self.rolling(contact, previous) }
    }

    /// Known part of the force and the torque on the particle.
    pub fn known_load(&self, contact: &Touching, expected: &Expected) -> [Vector; 2] {
        let [along, slip, roll] = self.resistances(contact);
        let normal = self.law.force(contact.overlap, contact.between) + along * expected.separation_rate;
        let [slides, rolls] = contact.memory.shares.map(|share| if share < 1.0 { 1.0 } else { 0.0 });
        let mut memory = contact.memory;
        memory.force += slip * (across(self.flow.strained(contact), contact.axis) - slides * expected.slip);
        memory.rolling += roll * (self.flow.rolled(contact) - rolls * expected.rolling);
        contact.load(normal, &memory)
    }

    /// Implicit resistances along the line of centres, to slip, and to rolling.
    pub fn resistances(&self, contact: &Touching) -> [f64; 3] {
        let (along, spring) = (self.normal_resistance(contact), self.tangential_resistance(contact));
        let of_share = |share: f64| if share < 1.0 { CUT * share * spring } else { spring };
        let [slip, rolling] = contact.memory.shares.map(of_share);
        let on = |friction: f64, resistance: f64| if friction > 0.0 { resistance } else { 0.0 };
        [along, on(self.law.friction, slip), on(self.law.rolling_friction, rolling)]
    }

    /// State of a contact at the end, from the expected and the actual motions.
    pub fn end(&self, contact: &Touching, expected: &Expected, motions: RigidMotions) -> Memory {
        let known = self.law.force(contact.overlap, contact.between);
        let separating = contact.separation_rate(motions.velocities) - expected.separation_rate;
        let normal = (known - self.normal_resistance(contact) * separating).max(0.0);
        let spring = self.tangential_resistance(contact);
        let force = contact.memory.force + spring * self.slip(contact, motions);
        let rolling = contact.memory.rolling + spring * self.rolling(contact, motions);
        let most = [self.law.coulomb_limit(normal), self.law.rolling_friction * normal];
        let shares = [share(force, most[0]), share(rolling, most[1])];
        Memory { force: shares[0] * force, rolling: shares[1] * rolling, normal, shares }
    }

    /// Slip velocity.
    fn slip(&self, contact: &Touching, motions: RigidMotions) -> Vector {
        contact.slip(motions.velocities, motions.angular_velocities, self.flow.strained(contact))
    }

    /// Rolling velocity.
    fn rolling(&self, contact: &Touching, motions: RigidMotions) -> Vector {
        contact.rolling(motions.angular_velocities) + self.flow.rolled(contact)
    }

    fn normal_resistance(&self, contact: &Touching) -> f64 {
        self.ahead.along * self.law.normal_stiffness(contact.overlap, contact.between)
    }

    fn tangential_resistance(&self, contact: &Touching) -> f64 {
        self.ahead.across * self.law.tangential_stiffness(contact.overlap, contact.between)
    }
}

/// Factor that limits the magnitude of a force to `most`.
fn share(force: Vector, most: f64) -> f64 {
    let length = force.length();
    if length > most { most / length } else { 1.0 }
}
