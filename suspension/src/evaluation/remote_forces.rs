//! Implicit forces and contacts of particles that move where the far field is evaluated.

use super::initial_guess::MOTION;
use super::{Comparison, Dynamics, Outcome, StageTime};
use crate::columns::EXPECTED;
use crate::error::step::StepError;
use crate::forces::acting::Acting;
use crate::forces::contacts::{CONTACT_NUMBERS, CONTACTS, Contacts, FOUND, too_many};
use domain::{Particles, RemoteList};
use fcm::{HeldLoads, MovingFlow};
use hydrodynamics::{Guess, HeldContacts, HeldForces, HeldPrediction, TooManyContacts};

/// Message of a panic, which would be a mistake in the program.
const HAS_CONTACTS: &str = "these spheres have contacts";

/// Columns from which the contacts of a solve follow, and the times of their prediction.
struct ContactLists {
    times: [f64; 2],
    expected: Option<RemoteList>,
    history: Option<RemoteList>,
    previous: [RemoteList; 2],
}

impl ContactLists {
    /// The contacts in a flow.
    fn of<'a>(&'a self, contacts: &'a Contacts, flow: MovingFlow) -> HeldContacts<'a> {
        HeldContacts {
            law: contacts.law(),
            slots: contacts.slots(),
            times: self.times,
            expected: self.expected.as_ref(),
            history: self.history.as_ref(),
            previous: Some(self.previous.each_ref()),
            flow,
        }
    }
}

impl Dynamics {
    /// [`Self::solve_at`] of particles that move where the far field is evaluated, in implicit steps.
    pub(super) fn solve_held(
        &mut self,
        particles: &mut Particles,
        guess: Guess,
        moment: &StageTime,
    ) -> Result<(Outcome, Option<Comparison>), StepError> {
        // The states that an earlier solve of this substep found.
        particles.remove(|name| name == FOUND);
        let velocities = moment.implicit.map(|time| (time, self.held_column(particles, EXPECTED, 3)));
        let lists = self.contact_lists(particles, moment);
        let contacts = match &lists {
            Some(lists) => Some(self.contact_loads(particles, lists)?),
            None => None,
        };
        let prediction = velocities.map(|(time, velocities)| HeldPrediction { time, velocities });
        let acting = Acting { held_forces: Some(HeldForces { prediction, contacts }), ..Acting::default() };
        let solved = self.solved(particles, &acting, &acting.ambient, guess, moment)?;
        self.record(particles, &solved);
        if let Some(lists) = lists.filter(|_| moment.implicit.is_some()) {
            self.note_contacts(particles, &lists);
        }
        Ok((Outcome::of(&solved), solved.kept.and_then(|kept| kept.compared)))
    }

    /// Columns from which the contacts of a solve follow; `None` without contacts.
    fn contact_lists(&self, particles: &mut Particles, moment: &StageTime) -> Option<ContactLists> {
        let contacts = self.forces.contacts.as_ref()?;
        let is_known = particles.columns.iter().any(|column| column.name == CONTACTS);
        let width = CONTACT_NUMBERS * contacts.slots();
        Some(ContactLists {
            times: moment.implicit.map_or([0.0; 2], |time| [time, moment.since_last_solution]),
            expected: moment.implicit.map(|_| self.held_column(particles, EXPECTED, 3)),
            history: is_known.then(|| self.held_column(particles, CONTACTS, width)),
            previous: MOTION.map(|name| self.held_column(particles, name, 3)),
        })
    }

    fn contact_loads(&mut self, particles: &Particles, lists: &ContactLists) -> Result<HeldLoads, StepError> {
        let Self { hydrodynamics, moving, forces, .. } = self;
        let contacts = lists.of(forces.contacts.as_ref().expect(HAS_CONTACTS), moving.moving_flow());
        let loads = hydrodynamics.contact_loads(moving.cell(), particles, &contacts);
        let loads = loads.map_err(|TooManyContacts { id }| too_many(id, contacts.slots));
        self.partition.comm().agree(loads).map_err(StepError::Contacts)
    }

    /// Stores the states of the contacts at the end of a substep, from the solution in the particles' columns.
    fn note_contacts(&mut self, particles: &mut Particles, lists: &ContactLists) {
        let motions = MOTION.map(|name| self.held_column(particles, name, 3));
        let Self { hydrodynamics, moving, forces, .. } = self;
        let contacts = forces.contacts.as_ref().expect(HAS_CONTACTS);
        let found = hydrodynamics.contact_ends(motions.each_ref(), &lists.of(contacts, moving.moving_flow()));
        particles.set_column(FOUND, CONTACT_NUMBERS * contacts.slots(), found);
    }
}
