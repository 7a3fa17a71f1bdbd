//! Contacts of particles that move where the far field is evaluated.

use crate::coupled_solver::CoupledSolver;
use domain::{ColumnValues, Particles, PeriodicBox, RemoteList, Units};
use fcm::{ContactLaw, HeldLoads, MovingFlow, TouchingParticles};
use lubrication::{Contact, Elasticity};

/// Contacts of particles that move where the far field is evaluated. Lists are in the order of ids and all numbers in
/// the original units.
#[derive(Clone, Copy)]
pub struct HeldContacts<'a> {
    /// Law of all contacts.
    pub law: &'a Contact,
    /// Largest number of contacts of a particle.
    pub slots: usize,
    /// Times over which implicit forces are predicted: from the present positions for springs along the line of
    /// centres, and from the start of the substep for tangential springs; 0 for forces at present.
    pub times: [f64; 2],
    /// Expected velocities with those of [`MovingFlow::carried`]; `None` for these.
    pub expected: Option<&'a RemoteList>,
    /// State of the contacts at the start of the substep: ten numbers a slot; `None` if there were none.
    pub history: Option<&'a RemoteList>,
    /// Velocities and angular velocities of the previous solution relative to the flow; `None` for zeros.
    pub previous: Option<[&'a RemoteList; 2]>,
    /// The background flow.
    pub flow: MovingFlow,
}

/// A particle with more contacts than slots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooManyContacts {
    /// Its id.
    pub id: u64,
}

impl CoupledSolver {
    /// The loads of [`Self::hold_loads`] plus the known parts of contact forces and torques. Their resistances are
    /// those of the solves that follow at the same positions with [`HeldForces::contacts`].
    ///
    /// # Panics
    ///
    /// Unless these particles have moved where the far field is evaluated.
    ///
    /// [`HeldForces::contacts`]: crate::HeldForces::contacts
    pub fn contact_loads(
        &mut self,
        cell: &PeriodicBox,
        particles: &Particles,
        contacts: &HeldContacts,
    ) -> Result<HeldLoads, TooManyContacts> {
        let (touching, mobility) = (contacts.in_units(self.units), self.far.mobility());
        mobility.follow(cell, particles);
        let found = mobility.contacts().expect(ELSEWHERE).loads(&touching, self.held_loads.as_ref());
        found.map_err(|place| TooManyContacts { id: id_at(&particles.ids, place) })
    }

    /// State of the contacts that [`Self::contact_loads`] found, at the end of the substep: ten numbers a slot, from
    /// velocities and angular velocities of the solution relative to the flow. The particles have not moved since.
    ///
    /// # Panics
    ///
    /// Unless the particles have moved where the far field is evaluated.
    pub fn contact_ends(&mut self, motions: [&RemoteList; 2], contacts: &HeldContacts) -> ColumnValues {
        let touching = contacts.in_units(self.units);
        self.far.mobility().contacts().expect(ELSEWHERE).ends(&touching, motions)
    }
}

/// Message of a panic, which would be a mistake in the program.
const ELSEWHERE: &str = "the far field moves these particles";

impl<'a> HeldContacts<'a> {
    /// The contacts for the far field, by the units of solves.
    fn in_units(&self, units: Units) -> TouchingParticles<'a> {
        let &Self { law, slots, times, expected, history, previous, flow } = self;
        TouchingParticles {
            units,
            law: ContactLaw {
                friction: law.friction,
                roughness: law.roughness,
                stiffness: law.stiffness * units.length * units.length,
                tangential_ratio: law.tangential_ratio,
                rolling_friction: law.rolling_friction,
                critical_load: law.critical_load,
            },
            is_hertz: law.elasticity == Elasticity::Hertz,
            slots,
            times,
            expected,
            history,
            previous,
            flow,
        }
    }
}

/// The id with a place in the order of ids.
fn id_at(ids: &[u64], place: usize) -> u64 {
    let mut sorted = ids.to_vec();
    sorted.sort_unstable();
    sorted[place]
}
