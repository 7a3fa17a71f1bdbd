//! Contacts between rough spheres: implicit springs, friction, and the history of each contact.

mod flow;
mod forces;
mod history;
mod statistics;
mod stiffness_adaptation;
mod touching;
mod warnings;

use crate::error::step::StepError;
use crate::forces::acting::{Acting, Configuration, Instant, Prediction, SolvedMotion};
use crate::forces::force::{Force, StressName};
use crate::model::Model;
use crate::model::radii::Radii;
use crate::neighbourhood::NeighbourLists;
use crate::scalars::ADAPTATION_NUMBERS;
use domain::parallel::stage;
use domain::{DomainView, ExpectedCounts, Failure, Particles, Tensor, Vector};
use fcm::{Loads, Motion};
use flow::{ContactFlow, strained};
pub use forces::{FORCE_NUMBERS, contact_force, of as force_numbers};
pub use history::keep;
use history::{CONTACT_NUMBERS, FOUND, Memory, most_contacts, note};
use hydrodynamics::ContactSprings;
use lubrication::Contact;
pub use statistics::ContactStatistics;
pub use stiffness_adaptation::StiffnessAdaptation;
use touching::{AllTouching, Touching, across};

/// The contacts of a suspension.
pub struct Contacts {
    law: Contact,
    /// Distance of centres up to which any two spheres touch.
    reach: f64,
    /// Largest number of contacts stored per particle.
    slots: usize,
    /// Extreme radii of the model.
    radii: [f64; 2],
    /// Whether a column has the state of the stiffness adaptation.
    settles: bool,
    /// Stiffness adaptation, if the stiffness adapts.
    adaptation: Option<StiffnessAdaptation>,
    /// Contacts of the solve in progress.
    forcing: Option<ContactForcing>,
    /// The `xy` component of the first moments at the end of the last solve under stress control.
    shear_moment: f64,
}

impl Force for Contacts {
    fn name(&self) -> &'static str {
        "contact"
    }

    /// Adds nothing: between steps, the loads on the fluid are those of the last solution.
    fn add_present_loads(&self, _at: &Configuration, _loads: &mut Loads) {}

    fn add_loads(&mut self, at: &mut Instant, acting: &mut Acting) -> Result<(), Failure> {
        let _stage = stage("contacts");
        let forcing = self.acting(at);
        forcing.add_to(&mut acting.loads);
        if at.prediction.is_some() {
            acting.resistances.contacts = forcing.springs();
        }
        self.forcing = Some(forcing);
        Ok(())
    }

    fn stresses(&self) -> Vec<StressName> {
        vec![StressName::symmetric("contact")]
    }

    fn moments(&self, at: &Configuration, _beyond: Option<&Prediction>) -> Vec<Vec<Tensor>> {
        vec![self.measured(at.particles, at.domain, at.lists).moments]
    }

    fn shear_moment(&self, _at: &Configuration, _beyond: Option<&Prediction>) -> f64 {
        self.shear_moment
    }

    fn follows_motion(&self) -> bool {
        true
    }

    fn solved(&mut self, particles: &mut Particles, solved: &SolvedMotion) -> Result<(), Failure> {
        let Some(forcing) = self.forcing.take() else { return Ok(()) };
        if solved.is_implicit {
            let noted = forcing.note(particles, solved.motion);
            solved.domain.comm().agree(noted)?;
        }
        self.shear_moment = if solved.is_stress_controlled { forcing.shear_moment(solved.motion) } else { 0.0 };
        Ok(())
    }

    fn explain(&self, _step: u64, source: Failure) -> StepError {
        StepError::Contacts(source)
    }

    /// Contacts at the start and at the end of a substep.
    fn numbers(&self, expected: &ExpectedCounts) -> usize {
        let of_adaptation = if self.settles { ADAPTATION_NUMBERS } else { 0 };
        2 * CONTACT_NUMBERS * most_contacts(self.radii, expected.total() as usize) + of_adaptation
    }

    fn warnings(&self, model: &Model, radii: &Radii) -> Vec<String> {
        warnings::warnings(model, radii)
    }
}

/// Times over which contact forces are predicted: from the positions of the evaluation for springs along the line of
/// centres, and from the start of the substep for tangential springs.
#[derive(Debug, Clone, Copy)]
struct PredictionTimes {
    along: f64,
    across: f64,
}

/// Contacts at the positions of an evaluation, with forces predicted for the end of the substep.
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
struct ContactForcing {
    law: Contact,
    slots: usize,
    ahead: PredictionTimes,
    touching: AllTouching,
    /// Expected motion of each contact in `touching`.
    expected: Vec<Expected>,
    flow: ContactFlow,
}

/// Expected relative motion at a contact.
#[derive(Debug, Clone, Copy)]
struct Expected {
    /// Rate at which the centres separate.
    separation_rate: f64,
    /// Slip velocity and rolling velocity, from the previous solution.
    slip: Vector,
    rolling: Vector,
}

/// Fraction of the derivative of a limited friction force that is treated implicitly.
const CUT: f64 = 0.5;

/// Row of a particle, id of the other, and the state of their contact at the end of the substep.
type End = (usize, u64, Memory);

impl Contacts {
    /// The contacts of a model.
    pub fn of(model: &Model) -> Option<Self> {
        let contacts = model.contacts?;
        let radii = model.species.iter().map(|s| s.radius);
        let radii = [radii.clone().fold(f64::INFINITY, f64::min), radii.fold(0.0, f64::max)];
        Some(Self {
            law: contacts.contact(model),
            reach: 0.0,
            slots: 0,
            radii,
            settles: contacts.settles(model),
            adaptation: None,
            forcing: None,
            shear_moment: 0.0,
        })
    }

    /// These contacts between spheres of given radii.
    #[must_use]
    pub fn between(self, radii: &Radii) -> Self {
        let extremes = [radii.smallest(), radii.largest()];
        let (reach, slots) = (self.law.reach([extremes[1]; 2]), most_contacts(extremes, radii.count()));
        Self { reach, slots, ..self }
    }

    /// These contacts with stiffness adaptation, or without it if `None`.
    #[must_use]
    pub fn adapting(mut self, adaptation: Option<StiffnessAdaptation>) -> Self {
        self.set_adaptation(adaptation);
        self
    }

    /// Stiffness adaptation, if the stiffness adapts.
    pub fn adaptation(&self) -> Option<StiffnessAdaptation> {
        self.adaptation
    }

    /// Sets the stiffness adaptation, and the stiffness from it.
    pub fn set_adaptation(&mut self, adaptation: Option<StiffnessAdaptation>) {
        self.adaptation = adaptation;
        self.law.stiffness = adaptation.map_or(self.law.stiffness, |adaptation| adaptation.stiffness());
    }

    /// Ends the adaptation: the stiffness stays at its present value.
    pub fn end_adaptation(&mut self) {
        self.adaptation.iter_mut().for_each(StiffnessAdaptation::end);
    }

    /// Present stiffness.
    pub fn stiffness(&self) -> f64 {
        self.law.stiffness
    }

    /// Distance of centres up to which any two spheres touch.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// All contacts. Collective.
    fn touching(&self, particles: &Particles, domain: DomainView, lists: &NeighbourLists) -> AllTouching {
        AllTouching::of(&self.law, particles, domain.cell, lists.near(particles, domain, self.reach))
    }

    /// Adapts the stiffness, unless the adaptation is over, after the flow has advanced by `strain`. Collective.
    pub fn adapt(&mut self, particles: &Particles, domain: DomainView, lists: &NeighbourLists, strain: f64) {
        let Some(mut adaptation) = self.adaptation.filter(|adaptation| !adaptation.is_over()) else { return };
        let touching = self.touching(particles, domain, lists);
        let mut largest = [statistics::largest_overlap(&self.law, &touching)];
        domain.comm().max(&mut largest);
        adaptation.adapt(largest[0], strain);
        self.set_adaptation(Some(adaptation));
    }

    /// Contacts of an evaluation, from the expected velocities relative to the flow, the expected change of the flow,
    /// and the motions of the previous solution. Collective.
    fn acting(&self, at: &Instant) -> ContactForcing {
        let (flow, before) = (ContactFlow::of(at.flow), at.previous);
        let ahead = PredictionTimes {
            along: at.prediction.map_or(0.0, |prediction| prediction.time),
            across: at.prediction.map_or(0.0, |_| at.since_last_solution),
        };
        let expected = at.prediction.map_or(&[][..], |prediction| prediction.velocities);
        let touching = self.touching(at.particles, at.domain, at.lists);
        let separation_rate = touching.extended(expected);
        let velocities = touching.extended(&before.velocities);
        let angular = touching.extended(&before.angular_velocities);
        let of_one = |contact: &Touching| Expected {
            separation_rate: contact.separation_rate(&separation_rate)
                + contact.axis.dot(strained(contact, flow.besides)),
            slip: contact.slip(&velocities, &angular, flow.strained(contact)),
            rolling: contact.rolling(&angular) + flow.rolled(contact),
        };
        let expected = touching.list.iter().map(of_one).collect();
        ContactForcing { law: self.law, slots: self.slots, ahead, touching, expected, flow }
    }

    /// Forces of the contacts of this rank's particles with others of higher id, as rows of numbers that
    /// [`contact_force`] reads. Collective.
    pub fn forces(
        &self,
        particles: &Particles,
        domain: DomainView,
        lists: &NeighbourLists,
    ) -> Vec<[f64; FORCE_NUMBERS]> {
        let touching = self.touching(particles, domain, lists);
        let own = |contact: &&Touching| particles.ids[contact.rows[0]] < contact.other;
        touching.list.iter().filter(own).map(|contact| forces::numbers(&self.law, contact, particles)).collect()
    }

    /// Averages and totals over the contacts. Collective.
    pub fn measured(&self, particles: &Particles, domain: DomainView, lists: &NeighbourLists) -> ContactStatistics {
        ContactStatistics::of(&self.law, &self.touching(particles, domain, lists), particles)
    }
}

impl ContactForcing {
    /// Adds the known part of contact forces and torques to the loads on this rank's particles.
    fn add_to(&self, loads: &mut Loads) {
        let owned = self.touching.present.owned();
        loads.forces.resize(owned, Vector::ZERO);
        loads.torques.resize(owned, Vector::ZERO);
        for (contact, expected) in self.touching.list.iter().zip(&self.expected) {
            let [along, slip, roll] = self.resistances(contact);
            let normal = self.law.force(contact.overlap, contact.between) + along * expected.separation_rate;
            let [slides, rolls] = contact.memory.shares.map(|share| if share < 1.0 { 1.0 } else { 0.0 });
            let mut memory = contact.memory;
            memory.force += slip * (across(self.flow.strained(contact), contact.axis) - slides * expected.slip);
            memory.rolling += roll * (self.flow.rolled(contact) - rolls * expected.rolling);
            let [force, torque] = contact.load(normal, &memory);
            loads.forces[contact.rows[0]] += force;
            loads.torques[contact.rows[0]] += torque;
        }
    }

    /// Implicit resistance of the contacts, particle by particle.
    fn springs(&self) -> Vec<Vec<ContactSprings>> {
        let mut springs = vec![Vec::new(); self.touching.present.owned()];
        for contact in &self.touching.list {
            let [normal, tangential, rolling] = self.resistances(contact);
            springs[contact.rows[0]].push(ContactSprings { other: contact.other, normal, tangential, rolling });
        }
        springs
    }

    /// Stores the state of the contacts at the end of the substep, from motions relative to the flow; [`keep`] makes it
    /// the current state. Fails if a particle has more contacts than slots. Collective.
    fn note(&self, particles: &mut Particles, motion: &Motion) -> Result<(), String> {
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

    /// The `xy` component of the symmetric first moments of this rank's contact forces at the end, from motions
    /// relative to the flow. Collective.
    fn shear_moment(&self, motion: &Motion) -> f64 {
        let ends = self.ends(motion);
        let of_one = |(contact, (_, _, memory)): (&Touching, &End)| {
            let [force, _] = contact.load(memory.normal, memory);
            let arm = contact.arms[0] * contact.axis;
            0.5 * (arm.x * force.y + arm.y * force.x)
        };
        self.touching.list.iter().zip(&ends).map(of_one).sum()
    }

    /// States of the contacts at the end, in the order of rows. Collective.
    fn ends(&self, motion: &Motion) -> Vec<End> {
        let velocities = self.touching.extended(&motion.velocities);
        let angular = self.touching.extended(&motion.angular_velocities);
        let end = |(contact, expected): (&Touching, &Expected)| {
            let stiffness = self.ahead.along * self.law.normal_stiffness(contact.overlap, contact.between);
            let known = self.law.force(contact.overlap, contact.between);
            let normal =
                (known - stiffness * (contact.separation_rate(&velocities) - expected.separation_rate)).max(0.0);
            let spring = self.ahead.across * self.law.tangential_stiffness(contact.overlap, contact.between);
            let slip = contact.slip(&velocities, &angular, self.flow.strained(contact));
            let force = contact.memory.force + spring * slip;
            let rolled = contact.rolling(&angular) + self.flow.rolled(contact);
            let rolling = contact.memory.rolling + spring * rolled;
            let most = [self.law.coulomb_limit(normal), self.law.rolling_friction * normal];
            let shares = [share(force, most[0]), share(rolling, most[1])];
            let memory = Memory { force: shares[0] * force, rolling: shares[1] * rolling, normal, shares };
            (contact.rows[0], contact.other, memory)
        };
        self.touching.list.iter().zip(&self.expected).map(end).collect()
    }

    /// Implicit resistances along the line of centres, to slip, and to rolling.
    fn resistances(&self, contact: &Touching) -> [f64; 3] {
        let along = self.ahead.along * self.law.normal_stiffness(contact.overlap, contact.between);
        let spring = self.ahead.across * self.law.tangential_stiffness(contact.overlap, contact.between);
        let of_share = |share: f64| if share < 1.0 { CUT * share * spring } else { spring };
        let [slip, rolling] = contact.memory.shares.map(of_share);
        let on = |friction: f64, resistance: f64| if friction > 0.0 { resistance } else { 0.0 };
        [along, on(self.law.friction, slip), on(self.law.rolling_friction, rolling)]
    }
}

/// Factor that limits the magnitude of a force to `most`.
fn share(force: Vector, most: f64) -> f64 {
    let length = force.length();
    if length > most { most / length } else { 1.0 }
}
