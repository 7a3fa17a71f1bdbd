//! Contacts between rough spheres: implicit springs, friction, and the history of each contact.

mod flow;
mod forces;
mod forcing;
mod history;
mod prediction;
mod statistics;
mod stiffness_adaptation;
#[cfg(test)]
mod tests;
mod touching;
mod warnings;

use crate::error::step::StepError;
use crate::forces::acting::{Acting, Configuration, Instant, Prediction, SolvedMotion};
use crate::forces::force::{Force, StressName};
use crate::model::Model;
use crate::model::radii::Radii;
use crate::neighbourhood::NeighbourLists;
use crate::scalars::ADAPTATION_NUMBERS;
use domain::parallel::{RowLists, stage};
use domain::{DomainView, ExpectedCounts, Failure, Particles, Tensor};
use fcm::Loads;
pub use forces::{FORCE_NUMBERS, contact_force, of as force_numbers};
use forcing::ContactForcing;
use history::most_contacts;
pub use history::{CONTACT_NUMBERS, CONTACTS, FOUND, keep, too_many};
use lubrication::Contact;
pub use statistics::ContactStatistics;
pub use stiffness_adaptation::StiffnessAdaptation;
use touching::AllTouching;

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
        let touching = self.touching(at.particles, at.domain, at.lists);
        let forcing = ContactForcing::new(&self.law, touching, at);
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
        self.shear_moment = 0.0;
        if !solved.is_implicit && !solved.is_stress_controlled {
            return Ok(());
        }
        let _stage = stage("contacts");
        let ends = forcing.ends(solved.motion);
        if solved.is_implicit {
            let noted = forcing.note(particles, self.slots, &ends);
            solved.domain.comm().agree(noted)?;
        }
        if solved.is_stress_controlled {
            self.shear_moment = forcing.shear_moment(&ends);
        }
        Ok(())
    }

    fn explain(&self, _step: u64, source: Failure) -> StepError {
        StepError::Contacts(source)
    }

    /// Contacts at the start and at the end of a substep.
    fn numbers(&self, expected: &ExpectedCounts) -> usize {
        let of_adaptation = if self.settles { ADAPTATION_NUMBERS } else { 0 };
        2 * CONTACT_NUMBERS * self.slots_of(expected.total() as usize) + of_adaptation
    }

    fn warnings(&self, model: &Model, radii: &Radii) -> Vec<String> {
        warnings::warnings(model, radii)
    }
}

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

    /// Largest number of contacts of a particle among this many.
    pub fn slots_of(&self, particles: usize) -> usize {
        most_contacts(self.radii, particles)
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

    /// Law of all contacts, with the present stiffness.
    pub fn law(&self) -> &Contact {
        &self.law
    }

    /// Largest number of contacts stored per particle.
    pub fn slots(&self) -> usize {
        self.slots
    }

    /// Distance of centres up to which any two spheres touch.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// All contacts. Collective.
    fn touching(&self, particles: &Particles, domain: DomainView, lists: &NeighbourLists) -> AllTouching {
        AllTouching::of(&self.law, particles, domain.cell, lists.near(particles, domain, self.reach))
    }

    /// Whether the stiffness still adapts.
    pub fn are_adapting(&self) -> bool {
        self.adaptation.is_some_and(|adaptation| !adaptation.is_over())
    }

    /// Adapts the stiffness after the flow has advanced by `strain`. Collective.
    pub fn adapt(&mut self, particles: &Particles, domain: DomainView, lists: &NeighbourLists, strain: f64) {
        let Some(mut adaptation) = self.adaptation else { return };
        let touching = self.touching(particles, domain, lists);
        let mut largest = [statistics::largest_overlap(&self.law, &touching)];
        domain.comm().max(&mut largest);
        adaptation.adapt(largest[0], strain);
        self.set_adaptation(Some(adaptation));
    }

    /// [`Self::adapt`] to the smallest gap of spheres within [`Self::reach`], over the mean radius.
    pub fn adapt_to_gap(&mut self, gap: f64, strain: f64) {
        if let Some(mut adaptation) = self.adaptation {
            adaptation.adapt((1.0 - gap / self.law.roughness).max(0.0), strain);
            self.set_adaptation(Some(adaptation));
        }
    }

    /// Forces of the contacts of this rank's particles with others of higher id, as rows of numbers that
    /// [`contact_force`] reads. Collective.
    pub fn forces(
        &self,
        particles: &Particles,
        domain: DomainView,
        lists: &NeighbourLists,
    ) -> Vec<[f64; FORCE_NUMBERS]> {
        let (law, ids, positions) = (&self.law, &particles.ids[..], &particles.positions[..]);
        let contacts = &self.touching(particles, domain, lists).list;
        let own = RowLists::of_rows(contacts.rows(), |row, list| {
            let of_row = contacts.of(row).iter().filter(|contact| ids[row] < contact.other);
            list.extend(of_row.map(|contact| forces::numbers(law, contact, ids[row], positions[row])));
        });
        own.into_items()
    }

    /// Averages and totals over the contacts. Collective.
    pub fn measured(&self, particles: &Particles, domain: DomainView, lists: &NeighbourLists) -> ContactStatistics {
        ContactStatistics::of(&self.law, &self.touching(particles, domain, lists), particles)
    }
}
